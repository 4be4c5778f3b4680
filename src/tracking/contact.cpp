// Lists of contacts.
#include "dartcast/contact.hpp"

namespace dartcast {

void ContactList::append(const ContactList& other) {
  const auto shift = static_cast<std::uint32_t>(walls.size());
  walls.insert(walls.end(), other.walls.begin(), other.walls.end());
  for (Contact c : other.contacts) {
    c.first_wall += shift;
    contacts.push_back(c);
  }
  crossings.insert(crossings.end(), other.crossings.begin(), other.crossings.end());
}

}  // namespace dartcast
