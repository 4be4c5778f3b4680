// Which callables are the library's own.
#pragma once

#include "dartcast/contact.hpp"

namespace dartcast::detail {

/// Whether respond_with() made this callable. Then it throws nothing.
bool is_library_response(const ContactCallback& respond);

}  // namespace dartcast::detail
