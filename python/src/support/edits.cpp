// Transactions in Python: which map they belong to, and when they have ended.
#include "support/edits.hpp"

#include <thread>

namespace py = pybind11;

namespace dartcast::python {
namespace {

CombinatorialMap& changeable(const MapHandle& map) {
  if (map.changeable == nullptr)
    throw InvalidArgument(
        "this map belongs to a complex, an environment or an edit: use ComplexEdit, or edit() of the environment");
  return *map.changeable;
}

// Another thread may still use the edit: waits until it does not. Called with Python's lock.
void close(EditHandle& edit) {
  while (!edit.usage->begin()) {
    const py::gil_scoped_release release;
    std::this_thread::yield();
  }
  edit.edit = nullptr;
  edit.usage->end();
}

}  // namespace

OwnTransaction::OwnTransaction(std::shared_ptr<MapHandle> of)
    : map(std::move(of)),
      use(*map->usage, "the map (another transaction on it may be open)"),
      transaction(changeable(*map)) {}

Transaction& TransactionHandle::open() const {
  if (edit) return edit->open().topology();
  if (of_surface) return of_surface();
  if (!own) throw InvalidArgument("this transaction has ended: use it in its `with` block only");
  return own->transaction;
}

void TransactionHandle::end() {
  if (is_of_edit()) throw InvalidArgument("this transaction belongs to an edit: end that");
  const Use last(*usage, "the transaction");
  own.reset();
}

std::function<void(ComplexEdit&)> edit_callback(const py::object& make) {
  if (PyCallable_Check(make.ptr()) == 0) throw py::type_error("make: expected a function of a ComplexEdit");
  return [function = py::handle(make)](ComplexEdit& open) {
    const py::gil_scoped_acquire acquire;
    const auto handle = std::make_shared<EditHandle>();
    handle->edit = &open;
    try {
      function(handle);
    } catch (...) {
      close(*handle);
      throw;
    }
    close(*handle);
  };
}

std::shared_ptr<MapHandle> map_of(const std::shared_ptr<TransactionHandle>& transaction) {
  const auto look = [transaction]() -> const CombinatorialMap& { return transaction->open().map(); };
  return std::make_shared<MapHandle>(MapHandle{nullptr, nullptr, nullptr, transaction->usage, look});
}

std::shared_ptr<MapHandle> map_of(const std::shared_ptr<EditHandle>& edit) {
  const auto look = [edit]() -> const CombinatorialMap& { return edit->open().map(); };
  return std::make_shared<MapHandle>(MapHandle{nullptr, nullptr, nullptr, edit->usage, look});
}

}  // namespace dartcast::python
