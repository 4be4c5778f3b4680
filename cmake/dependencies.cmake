# What the library needs to be built. Users of its headers need none of these.
find_package(Threads REQUIRED)
find_package(Boost 1.74 REQUIRED)  # headers only: Multiprecision, for the audit
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt 9 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(tomlplusplus 3.3 REQUIRED)
find_package(VTK 9.1 REQUIRED COMPONENTS CommonCore CommonDataModel IOCore IOLegacy IOXML)
set(DARTCAST_PRIVATE_HEADERS Boost::headers Eigen3::Eigen nlohmann_json::nlohmann_json)
set(DARTCAST_PRIVATE_LIBRARIES Threads::Threads fmt::fmt tomlplusplus::tomlplusplus VTK::CommonCore VTK::CommonDataModel
                               VTK::IOCore VTK::IOLegacy VTK::IOXML)
if(DARTCAST_THREADS STREQUAL "tbb")
  find_package(TBB REQUIRED)
  list(APPEND DARTCAST_PRIVATE_LIBRARIES TBB::tbb)
endif()
if(DARTCAST_APP)
  find_package(CLI11 2.1 REQUIRED)
endif()
if(DARTCAST_TESTS)
  find_package(GTest REQUIRED)
  find_package(rapidcheck REQUIRED)
  find_package(CGAL REQUIRED)  # the oracle only; never linked into the library or the command
endif()
