# Libraries over the rooms of src/, each on top of the one before, and dartcast::dartcast for all of them. The library mpi
# stands beside: it needs core alone, and is a component of its own.
# tools/check_includes.py has the order of the rooms, and checks that these lists agree with it.
set(core_rooms base predicates mesh generators topology complex editing surface parts tracking response environment)
set(simulation_rooms dynamics spheres solids bodies catheter simulation)
set(mpi_rooms distributed)
set(io_rooms formats meshing scene report output)
if(EMSCRIPTEN)  # what reads scenes and meshes; js/src/xml_tags.cpp in place of expat
  list(REMOVE_ITEM io_rooms report output)
endif()
# Public headers; core has all others.
set(simulation_headers dynamics spheres solids bodies catheter simulation plan deformation vector_field forces events scene statistics)
set(mpi_headers mpi_ranks)
set(io_headers mesh_files scene_file report replay run trajectory statistics_files)

# Adds dartcast_NAME, known as dartcast::NAME, from its rooms and public headers. Further arguments: libraries it uses.
function(add_dartcast_library name)
  set(target dartcast_${name})
  set(sources)
  foreach(room IN LISTS ${name}_rooms)
    file(GLOB_RECURSE found CONFIGURE_DEPENDS src/${room}/*.cpp)
    list(APPEND sources ${found})
  endforeach()
  if(EMSCRIPTEN)
    list(FILTER sources EXCLUDE REGEX "/formats/xml_tags\\.cpp$")
  endif()
  list(TRANSFORM ${name}_headers REPLACE "(.+)" "include/dartcast/\\1.hpp" OUTPUT_VARIABLE headers)
  add_library(${target} ${sources})
  add_library(dartcast::${name} ALIAS ${target})
  target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS include FILES ${headers})
  target_include_directories(${target} PRIVATE src)
  target_compile_features(${target} PUBLIC cxx_std_20)
  # Templates in headers take exact decisions: users must not contract a * b + c either.
  target_compile_options(${target} PUBLIC -ffp-contract=off)
  # EIGEN_DONT_VECTORIZE: the order of its sums must not depend on the instruction set.
  target_compile_definitions(${target} PRIVATE DARTCAST_VERSION="${PROJECT_VERSION}" EIGEN_DONT_VECTORIZE)
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:dartcast_flags> ${ARGN})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} VERSION ${PROJECT_VERSION}
                        SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} INSTALL_RPATH "$ORIGIN")
  if(NOT DARTCAST_SANITIZE AND CMAKE_SYSTEM_NAME STREQUAL "Linux")
    target_link_options(${target} PRIVATE LINKER:-z,defs)  # a library that uses what is above it does not link
  endif()
  if(EMSCRIPTEN)
    target_compile_options(${target} PRIVATE -O2 -fno-unroll-loops -fno-vectorize -fno-slp-vectorize)
  endif()
  # Where CMAKE_UNITY_BUILD is set (in all presets for tests: half of the time), the files of a room are compiled as one.
  # Small rooms above the core share a unit, since headers take a third of its time. In the core this would cost a step at
  # a corner 1.2% of its instructions. Files of tracking are units of their own if speed counts: what is called from one
  # place of a file alone is inlined there.
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  foreach(source IN LISTS sources)
    string(REGEX REPLACE ".*/([^/]+)/[^/]+$" "\\1" unit ${source})
    foreach(shared IN ITEMS "bodies catheter" "dynamics solids spheres" "formats vtk openfoam" "meshing scene")
      if(" ${shared} " MATCHES " ${unit} ")
        string(REPLACE " " "_" unit ${shared})
        break()
      endif()
    endforeach()
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${unit})
    if(source MATCHES "/src/tracking/" AND NOT DARTCAST_SANITIZE AND NOT CMAKE_BUILD_TYPE STREQUAL "Debug")
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    endif()
    # Kernels (src/base/simd_kernel.hpp): each includes the same .inl files. They pass vectors wider than the instruction
    # set's within the file alone; g++ 12 warns of that without naming a place.
    if(source MATCHES "_(avx2|portable)\\.cpp$")
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON COMPILE_OPTIONS -Wno-psabi)
    endif()
    # A page loads the engine: it is fast where steps spend their time, and else small.
    set(cold "_avx2|/(tally_step|trace|pausing_step|cell_tally|travelling_step|part_steps)\\.cpp")
    if(EMSCRIPTEN AND source MATCHES "/(tracking|predicates)/|_portable\\.cpp$" AND NOT source MATCHES "${cold}")
      set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS "-O3;-funroll-loops;-fvectorize;-fslp-vectorize")
    endif()
  endforeach()
endfunction()

file(GLOB core_headers RELATIVE ${PROJECT_SOURCE_DIR}/include/dartcast CONFIGURE_DEPENDS include/dartcast/*.hpp)
list(TRANSFORM core_headers REPLACE "\\.hpp$" "")
list(REMOVE_ITEM core_headers dartcast ${simulation_headers} ${io_headers} ${mpi_headers})
if(DARTCAST_THREADS STREQUAL "std")
  set_source_files_properties(src/base/parallel.cpp PROPERTIES COMPILE_DEFINITIONS DARTCAST_THREADS_STD)
endif()
set(DARTCAST_LIBRARIES core simulation)
add_dartcast_library(core "$<BUILD_INTERFACE:Boost::headers;Eigen3::Eigen>" fmt::fmt ${DARTCAST_THREAD_LIBRARIES})
add_dartcast_library(simulation "$<BUILD_INTERFACE:Boost::headers;Eigen3::Eigen>" fmt::fmt)
target_link_libraries(dartcast_simulation PUBLIC dartcast_core)
if(DARTCAST_IO)
  list(APPEND DARTCAST_LIBRARIES io)
  list(APPEND io_headers dartcast)  # the header that includes all others
  add_dartcast_library(io $<BUILD_INTERFACE:nlohmann_json::nlohmann_json> fmt::fmt tomlplusplus::tomlplusplus
                       EXPAT::EXPAT ZLIB::ZLIB ${LZ4_LIBRARY})
  target_include_directories(dartcast_io PRIVATE ${LZ4_INCLUDE_DIR})
  if(HDF5_INCLUDE_DIR AND HDF5_LIBRARY)
    target_include_directories(dartcast_io SYSTEM PRIVATE ${HDF5_INCLUDE_DIR})
    target_link_libraries(dartcast_io PRIVATE ${HDF5_LIBRARY})
    target_compile_definitions(dartcast_io PRIVATE DARTCAST_HDF5)
  endif()
  if(CMAKE_BUILD_TYPE STREQUAL "Release" AND NOT EMSCRIPTEN)
    target_compile_options(dartcast_io PRIVATE -O1)  # more takes half as long again to compile, and no run is faster
  endif()
  target_link_libraries(dartcast_io PUBLIC dartcast_simulation)
  if(NOT EMSCRIPTEN)
    include(cmake/viewer.cmake)
  endif()
endif()

# Not in dartcast::dartcast: programs that run alone need no MPI.
if(DARTCAST_MPI)
  add_dartcast_library(mpi MPI::MPI_CXX)
  target_link_libraries(dartcast_mpi PUBLIC dartcast_core)
endif()

# All libraries that are built, for users; for our own programs, with the headers of the rooms.
add_library(dartcast INTERFACE)
add_library(dartcast::dartcast ALIAS dartcast)
list(TRANSFORM DARTCAST_LIBRARIES PREPEND dartcast_ OUTPUT_VARIABLE targets)
target_link_libraries(dartcast INTERFACE ${targets})
if(DARTCAST_MPI)
  list(APPEND DARTCAST_LIBRARIES mpi)  # is installed, too
endif()
add_library(dartcast_rooms INTERFACE)
target_include_directories(dartcast_rooms INTERFACE ${PROJECT_SOURCE_DIR}/src)
target_link_libraries(dartcast_rooms INTERFACE dartcast dartcast_flags)
