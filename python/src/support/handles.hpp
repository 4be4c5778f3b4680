// The long-lived objects as Python holds them. An object keeps alive what it needs. Objects that share data share the
// mark of their use (in_use.hpp).
#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "dartcast/cell_complex.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/environment.hpp"
#include "support/in_use.hpp"

namespace dartcast::python {

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

  /// Calls f(environment) while it is in use.
  template <class F>
  auto call(const F& f) const {
    const Use use(*usage, "the environment");
    return f(std::as_const(*environment));
  }
  /// To change it. Throws InvalidArgument where it is borrowed: `remedy` says what to call instead.
  Environment& changeable(const char* remedy) const {
    if (borrowed) throw InvalidArgument(std::string("this environment belongs to a simulation: ") + remedy);
    return *environment;
  }
};

/// A set of particles.
struct ParticlesHandle {
  Particles particles;
  std::shared_ptr<Usage> usage = std::make_shared<Usage>();

  /// Calls f(particles) while the set is in use; to change it, without Python's lock.
  template <class F>
  auto call(const F& f) const {
    const Use use(*usage, "the set of particles");
    return f(particles);
  }
  template <class F>
  auto change(const F& f) {
    const Use use(*usage, "the set of particles");
    const pybind11::gil_scoped_release release;
    return f(particles);
  }
};

/// A complex of its own, or that of an environment, which only the environment may change.
struct ComplexHandle {
  std::shared_ptr<void> owner;
  const CellComplex* complex = nullptr;
  CellComplex* changeable = nullptr;  ///< null: it belongs to an environment
  std::shared_ptr<Usage> usage = std::make_shared<Usage>();

  /// Calls f(complex) while the complex is in use.
  template <class F>
  auto call(const F& f) const {
    const Use use(*usage, "the complex (an edit of it may be open)");
    return f(*complex);
  }
};

/// A map of its own, or that of a complex, a surface or an open edit.
struct MapHandle {
  std::shared_ptr<void> owner;
  const CombinatorialMap* map = nullptr;
  CombinatorialMap* changeable = nullptr;  ///< null: it belongs to something else
  std::shared_ptr<Usage> usage = std::make_shared<Usage>();
  std::function<const CombinatorialMap&()> of_edit = {};  ///< the map of an edit: throws where that has ended

  [[nodiscard]] const CombinatorialMap& read() const { return of_edit ? of_edit() : *map; }
  /// Calls f(map) while the map is in use.
  template <class F>
  auto call(const F& f) const {
    const Use use(*usage, "the map");
    return f(read());
  }
};

/// Points of an edit to which it can be rolled back: none beyond one that was returned to, and none before a commit.
class Savepoints {
 public:
  /// Returns its number, which no other savepoint of the process has.
  std::uint64_t add(const Transaction::Savepoint& savepoint);
  /// The savepoint; forgets all later ones. Throws InvalidArgument where it is none of these.
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

  [[nodiscard]] ComplexEdit& open() const {
    if (edit == nullptr)
      throw InvalidArgument(
          "this edit has ended: use it in its `with` block, or in the function given to edit(), only");
    return *edit;
  }
  /// Calls f(edit) while it is in use, without Python's lock.
  template <class F>
  auto change(const F& f) const {
    const Use use(*usage, "the edit");
    ComplexEdit& own_edit = open();
    const pybind11::gil_scoped_release release;
    return f(own_edit);
  }
  /// Throws InUse while another thread's call uses the edit. Undoes it where it is Python's own and not committed.
  void end() {
    const Use last(*usage, "the edit");
    edit = nullptr;
    own.reset();
  }
};

}  // namespace dartcast::python
