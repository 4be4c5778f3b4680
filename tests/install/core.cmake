# cmake -DWORK=... -DSOURCE=... -DCOMPILER=... -P core.cmake
# Builds and installs static libraries on few packages, and consumers on them: first core and simulation where VTK, toml++,
# JSON, CLI11 and CGAL are not to be found, with a consumer of the core alone; then io where VTK is not to be found.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/functions.cmake)
file(REMOVE_RECURSE ${WORK}/prefix ${WORK}/consumer ${WORK}/without_vtk)

set(absent)
foreach(package VTK tomlplusplus nlohmann_json CLI11 CGAL Bullet embree)
  list(APPEND absent -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
run(${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/build -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0
    -DCMAKE_UNITY_BUILD=ON -DBUILD_SHARED_LIBS=OFF -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DDARTCAST_IO=OFF
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

# Without VTK, and not told so: the message names the option.
set(with_io -DDARTCAST_IO=ON -DDARTCAST_APP=OFF -DCMAKE_DISABLE_FIND_PACKAGE_tomlplusplus=OFF
    -DCMAKE_DISABLE_FIND_PACKAGE_nlohmann_json=OFF)
execute_process(COMMAND ${CMAKE_COMMAND} ${with_io} -DDARTCAST_VTK=ON ${WORK}/build RESULT_VARIABLE status
                OUTPUT_QUIET ERROR_VARIABLE output)
if(status EQUAL 0 OR NOT output MATCHES "DARTCAST_VTK=OFF")
  message(FATAL_ERROR "without VTK, CMake ended with ${status} and said:\n${output}")
endif()

run(${CMAKE_COMMAND} ${with_io} -DDARTCAST_VTK=OFF ${WORK}/build)
run(${CMAKE_COMMAND} --build ${WORK}/build -j2)
run(${CMAKE_COMMAND} --install ${WORK}/build --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE}/tests/install/without_vtk -B ${WORK}/without_vtk -DCMAKE_PREFIX_PATH=${WORK}/prefix
    -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_DISABLE_FIND_PACKAGE_VTK=ON)
run(${CMAKE_COMMAND} --build ${WORK}/without_vtk)
run(${WORK}/without_vtk/consumer ${WORK}/without_vtk)
if(NOT output MATCHES "^10 particles\nVTK 0: .*-DDARTCAST_VTK=ON")
  message(FATAL_ERROR "the consumer without VTK printed:\n${output}")
endif()
