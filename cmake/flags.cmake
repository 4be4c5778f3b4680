# Warnings and sanitizers, for the project's own targets only; nothing of this reaches a user.
add_library(dartcast_flags INTERFACE)
target_compile_options(dartcast_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion)
# g++ 12 finds overlaps in its own std::string where there are none (its bug 105651).
target_compile_options(dartcast_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
# On 32 bits: counts of 64 bits that memory holds become sizes.
if(EMSCRIPTEN)
  target_compile_options(dartcast_flags INTERFACE -Wno-shorten-64-to-32)
endif()
if(DARTCAST_WERROR)
  target_compile_options(dartcast_flags INTERFACE -Werror)
endif()

if(DARTCAST_SANITIZE)
  add_compile_options(-fsanitize=${DARTCAST_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${DARTCAST_SANITIZE})
endif()

set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Debug, Release, RelWithDebInfo or MinSizeRel" FORCE)
endif()
