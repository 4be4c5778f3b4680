// Which vector instructions to use: chosen when the program runs.
#pragma once

#include <cstdint>

namespace dartcast::detail {

enum class InstructionSet : std::uint8_t { portable, avx2 };  // avx2: with BMI2, as every processor that has it

/// The best set that this machine has.
inline InstructionSet best_instruction_set() {
#if defined(__x86_64__)
  static const bool has_avx2 = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("bmi2") != 0;
  if (has_avx2) return InstructionSet::avx2;
#endif
  return InstructionSet::portable;
}

}  // namespace dartcast::detail
