// Errors: bad input raises an exception that says what, where and what to do. A collision is a result, never an error.
#pragma once

#include <stdexcept>
#include <string>

namespace dartcast {

/// Base of all exceptions of dartcast. After a throw the state is unchanged, unless the contract of a function says
/// otherwise.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An argument that breaks a stated precondition: a size that does not match, a number that is not finite, a stale
/// handle.
class InvalidArgument : public Error {
 public:
  using Error::Error;
};

/// A mesh or a file that cannot be used. The text names the file and the line, cell or point.
class InvalidMesh : public Error {
 public:
  using Error::Error;
};

/// An edit that would leave no valid map. The text names the cells and says what to do; the map is unchanged.
class EditRefused : public Error {
 public:
  using Error::Error;
};

/// A broken invariant of dartcast itself: please report it, with the replay in the text.
class InternalError : public Error {
 public:
  using Error::Error;
};

}  // namespace dartcast
