# The tiers of ./dev test. Each test is in one of them, which is its label: quick, python, install or mpi; in the build of
# a sanitizer, sanitize. The target TIER_tests builds what the tests of a tier run.

# add_to_tier(TIER [TESTS NAME...] [TARGETS NAME...]), after add_test(), in the same folder.
function(add_to_tier tier)
  cmake_parse_arguments(PARSE_ARGV 1 add "" "" "TESTS;TARGETS")
  if(DARTCAST_SANITIZE)
    set(tier sanitize)
  endif()
  if(NOT TARGET ${tier}_tests)
    add_custom_target(${tier}_tests)
  endif()
  foreach(test IN LISTS add_TESTS)
    set_property(TEST ${test} PROPERTY LABELS ${tier})
  endforeach()
  foreach(target IN LISTS add_TARGETS)
    add_dependencies(${tier}_tests ${target})
  endforeach()
endfunction()
