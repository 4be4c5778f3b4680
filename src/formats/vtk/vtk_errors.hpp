// VTK's error texts, caught instead of printed.
#pragma once

#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>

#include <string>

namespace dartcast {

/// While it lives, errors and warnings of VTK go here and not to the terminal. Only one lives at a time: others wait.
class VtkErrors {
 public:
  VtkErrors();
  ~VtkErrors();
  VtkErrors(const VtkErrors&) = delete;
  VtkErrors& operator=(const VtkErrors&) = delete;

  /// The first line of the first error; empty: none so far.
  [[nodiscard]] std::string first() const;

 private:
  int verbosity_;
  vtkSmartPointer<vtkOutputWindow> before_;
  vtkSmartPointer<vtkOutputWindow> window_;
};

}  // namespace dartcast
