// The long-lived objects as Python holds them. An object keeps alive what it needs. Objects that share data share the
// mark of their use (in_use.hpp).
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <memory>
#include <utility>

#include "dartcast/cell_complex.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/environment.hpp"
#include "support/in_use.hpp"

namespace dartcast::python {

// Each handle has use(), the mark of its use for a call, and object(), or target(): the object to be changed.

/// Calls f(object) on what a handle holds, while it is in use.
template <class Handle, class F>
auto read(const Handle& handle, const F& f) {
  const Use held = handle.use();
  return f(handle.object());
}
/// The same without Python's lock.
template <class Handle, class F>
auto read_long(const Handle& handle, const F& f) {
  return read(handle, [&](const auto& object) {
    const pybind11::gil_scoped_release release;
    return f(object);
  });
}
/// The same to change the object.
template <class Handle, class F>
auto change(Handle& handle, const F& f) {
  const Use held = handle.use();
  auto& object = handle.target();
  const pybind11::gil_scoped_release release;
  return f(object);
}

/// An environment: the caller's own, or that of a simulation, which nobody else may change.
struct EnvironmentHandle {
  std::shared_ptr<void> owner;  ///< what keeps it alive
  Environment* environment = nullptr;
  bool borrowed = false;  ///< of a simulation
  std::shared_ptr<Usage> usage = std::make_shared<Usage>();
  // The blocks of next_points().
  bool writing = false;              ///< one is open
  bool overwritten = false;          ///< one was left by an exception: the positions before the last move are lost
  std::weak_ptr<void> written = {};  ///< arrays of a block that still exist; they end at an edit at the latest

  /// Throws InvalidArgument while a block is open.
  void expect_no_writing(const char* call) const {
    if (writing)
      throw InvalidArgument(std::string(call) + ": a next_points() block of this environment is open: leave it first");
  }

  [[nodiscard]] Use use() const { return Use(*usage, "the environment"); }
  [[nodiscard]] const Environment& object() const { return *environment; }
  /// To change it. Throws InvalidArgument if it is borrowed: `remedy` says what to call instead.
  Environment& changeable(const char* remedy) const {
    if (borrowed) throw InvalidArgument(std::string("this environment belongs to a simulation: ") + remedy);
    return *environment;
  }
};

/// A set of particles.
struct ParticlesHandle {
  Particles particles;
  std::shared_ptr<Usage> usage = std::make_shared<Usage>();

  [[nodiscard]] Use use() const { return Use(*usage, "the set of particles"); }
  [[nodiscard]] const Particles& object() const { return particles; }
  [[nodiscard]] Particles& target() { return particles; }
};

/// A complex of its own, or that of an environment, which only the environment may change.
struct ComplexHandle {
  std::shared_ptr<void> owner;
  const CellComplex* complex = nullptr;
  CellComplex* changeable = nullptr;  ///< null: it belongs to an environment
  std::shared_ptr<Usage> usage = std::make_shared<Usage>();

  [[nodiscard]] Use use() const { return Use(*usage, "the complex (an edit of it may be open)"); }
  [[nodiscard]] const CellComplex& object() const { return *complex; }
};

/// A map of its own, or that of a complex, a surface or an open edit.
struct MapHandle {
  std::shared_ptr<void> owner;
  const CombinatorialMap* map = nullptr;
  CombinatorialMap* changeable = nullptr;  ///< null: it belongs to something else
  std::shared_ptr<Usage> usage = std::make_shared<Usage>();
  std::function<const CombinatorialMap&()> of_edit = {};  ///< the map of an edit: throws if that has ended

  [[nodiscard]] Use use() const { return Use(*usage, "the map"); }
  [[nodiscard]] const CombinatorialMap& object() const { return of_edit ? of_edit() : *map; }
};

/// Points of an edit to which it can be rolled back: none beyond one that was returned to, and none before a commit.
class Savepoints {
 public:
  /// Returns its number, which no other savepoint of the process has.
  std::uint64_t add(const Transaction::Savepoint& savepoint);
  /// The savepoint; forgets all later ones. Throws InvalidArgument if it is none of these.
  Transaction::Savepoint return_to(std::uint64_t number);
  void clear() { known_.clear(); }

 private:
  std::vector<std::pair<std::uint64_t, Transaction::Savepoint>> known_;
};

/// An edit of a complex that Python made: the complex is in use until it ends.
struct OwnEdit {
  std::shared_ptr<ComplexHandle> complex;
  Use use;
  ComplexEdit edit;

  explicit OwnEdit(std::shared_ptr<ComplexHandle> of);
};

/// An edit that is open. One of an environment ends with the call that made it: that calls end().
struct EditHandle {
  ComplexEdit* edit = nullptr;  ///< null: it has ended
  std::shared_ptr<Usage> usage = std::make_shared<Usage>();
  std::shared_ptr<Savepoints> savepoints = std::make_shared<Savepoints>();
  std::unique_ptr<OwnEdit> own = {};

  [[nodiscard]] Use use() const { return Use(*usage, "the edit"); }
  [[nodiscard]] ComplexEdit& target() const { return open(); }
  [[nodiscard]] ComplexEdit& open() const {
    if (edit == nullptr)
      throw InvalidArgument(
          "this edit has ended: use it in its `with` block, or in the function given to edit(), only");
    return *edit;
  }
  /// Throws InUse while another thread's call uses the edit. Undoes it if it is Python's own and not committed.
  void end() {
    const Use last(*usage, "the edit");
    edit = nullptr;
    own.reset();
  }
};

}  // namespace dartcast::python
