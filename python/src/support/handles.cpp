// Handles of edits and their savepoints.
#include "support/handles.hpp"

#include <algorithm>
#include <atomic>

namespace dartcast::python {

std::uint64_t Savepoints::add(const Transaction::Savepoint& savepoint) {
  static std::atomic<std::uint64_t> last = 0;
  known_.emplace_back(++last, savepoint);
  return known_.back().first;
}

Transaction::Savepoint Savepoints::return_to(std::uint64_t number) {
  const auto at = std::find_if(known_.begin(), known_.end(), [&](const auto& s) { return s.first == number; });
  if (at == known_.end())
    throw InvalidArgument("this savepoint is of another edit, or was undone itself, or is older than the last commit");
  known_.erase(at + 1, known_.end());
  return known_.back().second;
}

namespace {

CellComplex& changeable(const ComplexHandle& complex) {
  if (complex.changeable == nullptr)
    throw InvalidArgument("this complex belongs to an environment: call edit() of the environment");
  return *complex.changeable;
}

}  // namespace

OwnEdit::OwnEdit(std::shared_ptr<ComplexHandle> of)
    : complex(std::move(of)),
      use(*complex->usage, "the complex (another edit of it may be open)"),
      edit(changeable(*complex)) {}

}  // namespace dartcast::python
