// Binds the class Transaction of dartcast/map_edits.hpp, as a context manager.
#include "transaction.hpp"

#include "support/members.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::transaction {
namespace {

using Class = py::class_<TransactionHandle, std::shared_ptr<TransactionHandle>>;

constexpr std::size_t max_faces = 0x3fff;

// In an edit of a complex, commit() finds a cell's Steiner point, and a face keeps that of the face it continues.
void expect_points_kept(const CombinatorialMap& map, const CellDraft& draft) {
  if (draft.point.valid()) throw InvalidArgument("drafts: name no Steiner point of a cell; commit() finds it");
  for (const DraftFace& f : draft.faces) {
    if (!f.point.valid()) continue;
    if (f.from.valid()) expect_face(map, f.from);
    if (!f.from.valid() || map.point(f.from) != f.point)
      throw InvalidArgument("drafts: a face may only keep the Steiner point of the face that it continues");
  }
}

void check_drafts(const CombinatorialMap& map, std::span<const CellDraft> drafts, bool of_complex) {
  for (const CellDraft& draft : drafts) {
    if (draft.faces.size() > max_faces) throw InvalidArgument("drafts: a cell has more than 16383 faces");
    for (const DraftFace& f : draft.faces) {
      if (f.patch.value >= map.patch_names().size())
        throw InvalidArgument("drafts: there is no patch " + std::to_string(f.patch.value));
    }
    if (of_complex) expect_points_kept(map, draft);
  }
}

std::vector<Cell> replace(const TransactionHandle& h, const std::vector<Cell>& removed,
                          const std::vector<CellDraft>& drafts) {
  return change(h, [&](Transaction& t) {
    check_drafts(t.map(), drafts, h.is_of_edit());
    return t.replace(removed, drafts);
  });
}

void expect_own(const TransactionHandle& h) {
  if (h.is_of_edit()) throw InvalidArgument("this transaction belongs to an edit: call the same function of that");
}

void roll_back(const TransactionHandle& h, const std::optional<SavepointHandle>& to) {
  expect_own(h);
  change(h, [&](Transaction& t) {
    if (to) {
      t.roll_back(h.savepoints->return_to(to->number));
    } else {
      h.savepoints->clear();
      t.roll_back();
    }
  });
}

EditReport commit(const TransactionHandle& h) {
  expect_own(h);
  return change(h, [&](Transaction& t) {
    h.savepoints->clear();
    return t.commit();
  });
}

void bind_changes(Class& c) {
  members_of_Transaction(c);
  c.def("replace", &replace, about("Transaction::replace"));
  c.def(
      "savepoint",
      [](const TransactionHandle& h) {
        return change(h, [&](Transaction& t) { return SavepointHandle{h.savepoints->add(t.savepoint())}; });
      },
      "A point in the sequence to which roll_back() can return.");
  c.def("roll_back", &roll_back, py::arg("to") = py::none(),
        "Undoes everything after a savepoint, or since the last commit. Raises InvalidArgument where the savepoint is "
        "none of this transaction, or was itself undone, and where the transaction belongs to an edit of a complex.");
  c.def("commit", &commit,
        about("Transaction::commit", "Raises InvalidArgument where the transaction belongs to an edit of a complex."));
}

void bind_reads(Class& c) {
  c.def(
      "created",
      [](const TransactionHandle& h, std::size_t i) {
        return change(h, [&](const Transaction& t) {
          expect_number(i, t.created_count(), "created vertex");
          return t.created(i);
        });
      },
      about("Transaction::created"));
  c.def_property_readonly(
      "map", [](const std::shared_ptr<TransactionHandle>& h) { return map_of(h); },
      "The map as it is now. It can be read until the transaction ends.");
}

}  // namespace

void bind(py::module_& m) {
  Class c(m, "Transaction",
          about("Transaction",
                "A transaction on a map of its own is a context manager: leaving its block without commit() undoes the "
                "edits. While it is open, the map can be read through `transaction.map` only."));
  const py::class_<SavepointHandle> savepoint(c, "Savepoint", doc("Transaction::Savepoint"));
  c.def(py::init([](const std::shared_ptr<MapHandle>& map) {
          auto made = std::make_shared<TransactionHandle>();
          const py::gil_scoped_release release;
          made->own = std::make_unique<OwnTransaction>(map);
          return made;
        }),
        py::arg("map").none(false),
        "Opens a transaction on a map of its own. Raises InvalidArgument where the map belongs to something else, and "
        "InUse where another transaction on it is open.");
  bind_changes(c);
  bind_reads(c);
  c.def("__enter__", [](const std::shared_ptr<TransactionHandle>& h) {
    static_cast<void>(h->open());
    return h;
  });
  c.def("__exit__", [](TransactionHandle& h, const py::args& /*raised*/) { h.end(); });
}

}  // namespace dartcast::python::transaction
