# cmake -DBUILD=... -DWORK=... -DSOURCE=... -DCOMPILER=... -P all.cmake
# Installs the build into an empty prefix, builds programs against that alone, runs them and looks at what they print.
file(REMOVE_RECURSE ${WORK})

include(${CMAKE_CURRENT_LIST_DIR}/functions.cmake)

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE}/tests/install/all -B ${WORK}/build -DCMAKE_PREFIX_PATH=${WORK}/prefix
    -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_BUILD_TYPE=Release -DEXAMPLES=${SOURCE}/examples)
run(${CMAKE_COMMAND} --build ${WORK}/build -j2)

file(STRINGS ${WORK}/build/CMakeCache.txt found REGEX "^dartcast_DIR:")
string(FIND "${found}" "${WORK}/prefix/" place)
if(place EQUAL -1)
  message(FATAL_ERROR "the programs were built against another dartcast: ${found}")
endif()

run(${WORK}/build/consumer)
if(NOT output STREQUAL "700 cells\nsign 1\n")
  message(FATAL_ERROR "consumer printed:\n${output}")
endif()
file(GLOB examples ${SOURCE}/examples/*.cpp)
foreach(source IN LISTS examples)
  cmake_path(GET source STEM name)
  run(${WORK}/build/${name})
  message(STATUS "${name}:\n${output}")
  if(output STREQUAL "")
    message(FATAL_ERROR "the example ${name} printed nothing")
  endif()
endforeach()

if(EXISTS ${WORK}/prefix/bin/dartcast)
  run(${WORK}/prefix/bin/dartcast --version)
  if(NOT output MATCHES "${VERSION}")
    message(FATAL_ERROR "the installed command says of its version: ${output}")
  endif()
endif()
file(GLOB_RECURSE licence ${WORK}/prefix/share/doc/dartcast/LICENSE)
if(NOT licence)
  message(FATAL_ERROR "no licence was installed")
endif()
