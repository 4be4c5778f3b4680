// Expectations that many tests share.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "dartcast/audit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast::test {

inline void expect_near(const Vec3& a, const Vec3& b, double within = 1e-14) {
  EXPECT_LE(norm(a - b), within) << a.x << " " << a.y << " " << a.z << " instead of " << b.x << " " << b.y << " "
                                 << b.z;
}

/// Every particle is where its state says.
inline void expect_audited(const CellComplex& complex, const Particles& particles) {
  const Audit found = audit(complex, particles);
  ASSERT_EQ(found.failed, 0U) << found.first;
}

/// The text of the error that a call throws; empty: none.
inline std::string error_text(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& e) {
    return e.what();
  }
  return {};
}

/// The call must throw InvalidArgument, with these words in it.
inline void expect_refused(const std::function<void()>& call, const std::string& words) {
  try {
    call();
    ADD_FAILURE() << "not refused: " << words;
  } catch (const InvalidArgument& e) {
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
  }
}

}  // namespace dartcast::test
