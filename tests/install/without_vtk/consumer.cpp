// Calls the shared library that holds dartcast.
void run_without_vtk(const char* folder);

int main(int /*count*/, char** arguments) { run_without_vtk(arguments[1]); }
