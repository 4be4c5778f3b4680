// The order in which parts of a simulation follow edits, and who follows those that are made again.
#include "simulation/followers.hpp"

#include <gtest/gtest.h>

#include <string>

namespace dartcast::followers_test {

TEST(Followers, AreCalledInTheirOrder) {
  Followers followers;
  std::string called;
  followers.add([&](const ComplexEditReport& edit, OrphanPolicy /*orphaned*/) {
    called += edit.boundary_shift > 1.0 ? 'a' : '?';
  });
  followers.add([&](const ComplexEditReport& /*edit*/,
                    OrphanPolicy orphaned) { called += orphaned == OrphanPolicy::hold ? 'b' : '?'; },
                false);
  followers.add([&](const ComplexEditReport& /*edit*/, OrphanPolicy /*orphaned*/) { called += 'c'; });
  ComplexEditReport edit;
  edit.boundary_shift = 2.0;
  followers.call(edit, OrphanPolicy::hold);
  EXPECT_EQ(called, "abc");
  {
    const Followers::Repeating repeating(followers);
    followers.call(edit, OrphanPolicy::hold);
    EXPECT_EQ(called, "abcac");
  }
  followers.call(edit, OrphanPolicy::hold);
  EXPECT_EQ(called, "abcacabc");
}

}  // namespace dartcast::followers_test
