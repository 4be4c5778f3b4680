// Everything that a step reports, as words to compare to the bit.
#pragma once

#include <cstdint>
#include <vector>

#include "dartcast/contact.hpp"
#include "dartcast/step.hpp"

namespace dartcast::test {

using Words = std::vector<std::uint64_t>;

Words words_of(const ContactList& list);
/// Those of one contact, without its place in its list.
Words words_of(const ContactList& list, const Contact& c);
/// Without its counts.
Words words_of(const StepReport& report);
Words words_of(const Counters& c);

}  // namespace dartcast::test
