# cmake -DWORK=... -DSOURCE=... -DCOMPILER=... -P core.cmake
# Builds and installs core and simulation where VTK, toml++, JSON, CLI11 and CGAL are not to be found, and a consumer of the
# core alone on that.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/functions.cmake)
file(REMOVE_RECURSE ${WORK}/prefix ${WORK}/consumer)

set(absent)
foreach(package VTK tomlplusplus nlohmann_json CLI11 CGAL Bullet embree)
  list(APPEND absent -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
run(${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/build -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0
    -DCMAKE_UNITY_BUILD=ON -DDARTCAST_IO=OFF
    -DDARTCAST_TESTS=OFF -DDARTCAST_EXAMPLES=OFF -DCMAKE_CXX_COMPILER=${COMPILER} ${absent})
run(${CMAKE_COMMAND} --build ${WORK}/build -j2)
run(${CMAKE_COMMAND} --install ${WORK}/build --prefix ${WORK}/prefix)
file(GLOB headers RELATIVE ${WORK}/prefix/include/dartcast ${WORK}/prefix/include/dartcast/*)
foreach(header mesh_files.hpp scene_file.hpp run.hpp trajectory.hpp dartcast.hpp)
  if(header IN_LIST headers)
    message(FATAL_ERROR "without the library io, ${header} was installed")
  endif()
endforeach()

run(${CMAKE_COMMAND} -S ${SOURCE}/tests/install/core -B ${WORK}/consumer -DCMAKE_PREFIX_PATH=${WORK}/prefix
    -DCMAKE_CXX_COMPILER=${COMPILER})
run(${CMAKE_COMMAND} --build ${WORK}/consumer)
run(${WORK}/consumer/consumer)
if(NOT output STREQUAL "t = 0.50 at x = 4.00\n")
  message(FATAL_ERROR "the consumer of the core printed:\n${output}")
endif()
