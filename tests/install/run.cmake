# cmake -DBUILD=... -DWORK=... -DSOURCE=... -DCOMPILER=... -DFLAGS=... -DVERSION=... -P run.cmake
# Installs what was built into an empty prefix, builds programs against that alone, runs them and looks at what they print.
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${WORK})

# Runs a command; its output is in `output`. Any failure ends the test.
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "'${command}' ended with ${status}:\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

# Runs a command that must print what matches a regular expression.
function(expect pattern)
  run(${ARGN})
  if(NOT output MATCHES "${pattern}")
    message(FATAL_ERROR "'${ARGN}' printed:\n${output}\nThis does not match ${pattern}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
file(READ ${SOURCE}/README.md readme)
string(REGEX MATCH "```cpp\n([^`]*)```" ignored "${readme}")
file(WRITE ${WORK}/readme.cpp "${CMAKE_MATCH_1}")
run(${CMAKE_COMMAND} -S ${SOURCE}/tests/install -B ${WORK}/build -DCMAKE_PREFIX_PATH=${WORK}/prefix
    -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS} -DREADME_PROGRAM=${WORK}/readme.cpp)
run(${CMAKE_COMMAND} --build ${WORK}/build -j2)
file(STRINGS ${WORK}/build/CMakeCache.txt found REGEX "^dartcast_DIR:")
string(FIND "${found}" "${WORK}/prefix/" place)
if(place EQUAL -1)
  message(FATAL_ERROR "the programs were built against another dartcast: ${found}")
endif()

expect("^t = 0\\.50 at x = 4\\.00\n$" ${WORK}/build/core_consumer)
expect("^700 cells\nsign 1\n$" ${WORK}/build/consumer)
expect("^t = 0\\.500 at x = 4\\.000\n$" ${WORK}/build/readme)
expect("^10 particles\n700 cells\n$" ${WORK}/build/part_consumer ${WORK})
file(GLOB_RECURSE licence ${WORK}/prefix/share/doc/dartcast/LICENSE)
if(NOT licence)
  message(FATAL_ERROR "no licence was installed")
endif()
if(EXISTS ${WORK}/prefix/bin/dartcast)
  expect("${VERSION}" ${WORK}/prefix/bin/dartcast --version)
endif()

# The same program without CMake. The file for pkg-config names shared libraries.
file(GLOB_RECURSE shared ${WORK}/prefix/*/libdartcast_core.so)
find_program(PKGCONFIG pkg-config)
if(PKGCONFIG AND shared)
  cmake_path(GET shared PARENT_PATH libraries)
  run(${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${libraries}/pkgconfig ${PKGCONFIG} --cflags --libs dartcast)
  separate_arguments(flags UNIX_COMMAND "${output}")
  run(${COMPILER} ${WORK}/readme.cpp ${flags} -o ${WORK}/by_pkgconfig)
  expect("t = 0\\.5" ${CMAKE_COMMAND} -E env LD_LIBRARY_PATH=${libraries} ${WORK}/by_pkgconfig)
endif()
