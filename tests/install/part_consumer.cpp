// Calls the shared library that holds dartcast.
void run_part(const char* folder);

int main(int /*count*/, char** arguments) { run_part(arguments[1]); }
