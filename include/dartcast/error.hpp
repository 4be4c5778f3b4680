// Errors: bad input raises an exception that says what, where and what to do. A collision is a result, never an error.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

namespace dartcast {

struct StepReplay;  // dartcast/step_replay.hpp

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

/// A broken invariant of dartcast itself: please report it, with the replay if there is one.
class InternalError : public Error {
 public:
  using Error::Error;
  InternalError(const std::string& text, std::shared_ptr<const StepReplay> replay)
      : Error(text), replay_(std::move(replay)) {}
  /// The step that met it, with the cells around (write_replay() in dartcast/replay.hpp); null: none was recorded.
  [[nodiscard]] const std::shared_ptr<const StepReplay>& replay() const { return replay_; }

 private:
  std::shared_ptr<const StepReplay> replay_;
};

}  // namespace dartcast
