// For code that is compiled once for each instruction set: a kernel. Its .inl files are included by two .cpp files:
// NAME_portable.cpp, and NAME_avx2.cpp, which defines DARTCAST_AVX2 first. An .inl file that is opened alone is the
// portable one.
//
// An .inl file first includes what it needs, then opens a region for its own code. Functions of other headers must not
// be compiled for instructions that the machine may not have.
//
//   DARTCAST_BEGIN_KERNEL
//   namespace dartcast::detail::DARTCAST_SIMD {
//   namespace {  // what is called from one place alone is inlined there
//   ...
//   DARTCAST_END_KERNEL
#pragma once

#if !defined(DARTCAST_AVX2)
#if defined(__SSE2__)
#include <emmintrin.h>
#endif
#define DARTCAST_SIMD portable
#define DARTCAST_BEGIN_KERNEL
#define DARTCAST_END_KERNEL
#else
#include <immintrin.h>
#define DARTCAST_SIMD avx2
#if defined(__clang__)
#define DARTCAST_BEGIN_KERNEL \
  _Pragma("clang attribute push(__attribute__((target(\"avx2,bmi2\"))), apply_to = function)")
#define DARTCAST_END_KERNEL _Pragma("clang attribute pop")
#else
#define DARTCAST_BEGIN_KERNEL _Pragma("GCC push_options") _Pragma("GCC target(\"avx2,bmi2\")")
#define DARTCAST_END_KERNEL _Pragma("GCC pop_options")
#endif
#endif
