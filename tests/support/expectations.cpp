#include "support/expectations.hpp"

#include "dartcast/error.hpp"

namespace dartcast::test {

void expect_near(const Vec3& a, const Vec3& b, double within) {
  EXPECT_LE(norm(a - b), within) << a.x << " " << a.y << " " << a.z << " instead of " << b.x << " " << b.y << " "
                                 << b.z;
}

void expect_audited(const CellComplex& complex, const Particles& particles) {
  const Audit found = audit(complex, particles);
  ASSERT_EQ(found.failed, 0U) << found.first;
}

std::string error_text(const Call& call) {
  try {
    call();
  } catch (const Error& e) {
    return e.what();
  }
  return {};
}

std::string refusal(const Call& call) {
  try {
    call();
  } catch (const EditRefused& e) {
    return std::string("refused: ") + e.what();
  } catch (const InvalidArgument& e) {
    return std::string("invalid: ") + e.what();
  }
  return "done";
}

void expect_refused(const Call& call, const std::string& words) {
  try {
    call();
    ADD_FAILURE() << "not refused: " << words;
  } catch (const InvalidArgument& e) {
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
  }
}

void expect_parts(const std::string& text, std::initializer_list<const char*> parts) {
  for (const char* part : parts) EXPECT_NE(text.find(part), std::string::npos) << "no \"" << part << "\" in: " << text;
}

}  // namespace dartcast::test
