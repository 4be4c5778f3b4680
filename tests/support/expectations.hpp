// Expectations that many tests share.
#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <memory>
#include <string>

#include "dartcast/audit.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast::test {

/// A call to be made by the function that gets it: a std::function takes eight times as long to compile.
class Call {
 public:
  template <class F>
  Call(const F& lambda)  // NOLINT(google-explicit-constructor): is passed as it is
      : lambda_(std::addressof(lambda)),
        run_([](const void* f) { static_cast<void>((*static_cast<const F*>(f))()); }) {}
  void operator()() const { run_(lambda_); }

 private:
  const void* lambda_;
  void (*run_)(const void*);
};

void expect_near(const Vec3& a, const Vec3& b, double within = 1e-14);

/// Every particle is where its state says.
void expect_audited(const CellComplex& complex, const Particles& particles);

/// The text of the error that a call throws; empty: none.
std::string error_text(const Call& call);

/// The same with "refused: " before the text of EditRefused and "invalid: " before that of InvalidArgument; "done": none.
std::string refusal(const Call& call);

/// The call must throw InvalidArgument, with these words in it.
void expect_refused(const Call& call, const std::string& words);

/// A text must have all of these parts.
void expect_parts(const std::string& text, std::initializer_list<const char*> parts);

}  // namespace dartcast::test
