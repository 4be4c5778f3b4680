// Ranks that an object of Python stands for.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>

#include "dartcast/ranks.hpp"

namespace dartcast::python {

/// Calls the object's functions of the same names. To be made with Python's lock; the functions take it.
class PythonRanks final : public Ranks {
 public:
  explicit PythonRanks(pybind11::object object);
  PythonRanks(const PythonRanks&) = delete;
  PythonRanks& operator=(const PythonRanks&) = delete;
  ~PythonRanks() override;

  [[nodiscard]] unsigned rank() const override { return rank_; }
  [[nodiscard]] unsigned size() const override { return size_; }
  std::vector<std::string> gather(std::string bytes) override;
  std::string broadcast(std::string bytes) override;
  std::vector<std::string> exchange(std::vector<std::string> bytes) override;
  void sum(std::span<std::uint64_t> values) override;
  bool fail(const std::string& why) noexcept override;

 private:
  pybind11::object object_;
  unsigned rank_;
  unsigned size_;
};

/// None if the object is None.
std::unique_ptr<PythonRanks> python_ranks(const pybind11::object& object);

}  // namespace dartcast::python
