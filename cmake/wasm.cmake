# For WebAssembly by Debian's emscripten; programs run under node. Headers of Boost, Eigen, fmt and others
# are the machine's own.
include(/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake)
set(headers ${CMAKE_BINARY_DIR}/headers/include)
file(MAKE_DIRECTORY ${headers})
foreach(name IN ITEMS boost eigen3 fmt nlohmann toml++ lz4.h zlib.h zconf.h)
  file(CREATE_LINK /usr/include/${name} ${headers}/${name} SYMBOLIC)
endforeach()
set(DARTCAST_WASM_HEADERS ${headers})
set(CMAKE_CXX_FLAGS_RELEASE_INIT "-O3 -DNDEBUG")
string(APPEND CMAKE_CXX_FLAGS_INIT " -msimd128 -fwasm-exceptions -include ${CMAKE_CURRENT_LIST_DIR}/old_libcxx.hpp")
