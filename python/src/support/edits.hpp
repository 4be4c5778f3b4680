// Transactions in Python: of a map of its own, or of an edit of a complex.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <memory>
#include <utility>

#include "dartcast/map_edits.hpp"
#include "support/handles.hpp"

namespace dartcast::python {

/// A transaction that Python made on a map: the map is in use until it ends.
struct OwnTransaction {
  std::shared_ptr<MapHandle> map;
  Use use;
  Transaction transaction;

  explicit OwnTransaction(std::shared_ptr<MapHandle> of);
};

struct TransactionHandle {
  std::shared_ptr<EditHandle> edit;  ///< of a complex; null: it has `own`, or has ended
  std::unique_ptr<OwnTransaction> own;
  std::shared_ptr<Usage> usage = std::make_shared<Usage>();
  std::shared_ptr<Savepoints> savepoints = std::make_shared<Savepoints>();
  std::function<Transaction&()> of_surface = {};  ///< that of a surface's edit: throws if that has ended

  [[nodiscard]] Transaction& open() const;
  /// Whether it belongs to an edit, with which it ends.
  [[nodiscard]] bool is_of_edit() const { return edit != nullptr || of_surface != nullptr; }
  /// As EditHandle::end().
  void end();
  [[nodiscard]] Use use() const { return Use(*usage, "the transaction"); }
  [[nodiscard]] const Transaction& object() const { return open(); }
  [[nodiscard]] Transaction& target() const { return open(); }
};

/// A number that names a savepoint (Savepoints::add).
struct SavepointHandle {
  std::uint64_t number = 0;
};

/// The function for an edit of an environment or a simulation: make(edit) is called with Python's lock. The edit ends
/// with it, and no other thread uses it then. `make` outlives the function.
std::function<void(ComplexEdit&)> edit_callback(const pybind11::object& make);

/// The map as the edit has changed it so far. It can be read while the edit is open.
std::shared_ptr<MapHandle> map_of(const std::shared_ptr<TransactionHandle>& transaction);
std::shared_ptr<MapHandle> map_of(const std::shared_ptr<EditHandle>& edit);

}  // namespace dartcast::python
