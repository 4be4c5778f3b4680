// Catches VTK's error texts with an output window of its own, one caller at a time.
#include "formats/vtk/vtk_errors.hpp"

#include <vtkLogger.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>

#include <mutex>

namespace dartcast {
namespace {

/// VTK has one output window for the whole process.
std::mutex& window_mutex() {
  static std::mutex mutex;
  return mutex;
}

class Catcher : public vtkOutputWindow {
 public:
  static Catcher* New() { VTK_STANDARD_NEW_BODY(Catcher); }
  void DisplayText(const char* text) override { keep(text); }
  void DisplayErrorText(const char* text) override { keep(text); }
  void DisplayWarningText(const char* text) override { keep(text); }
  void DisplayGenericWarningText(const char* text) override { keep(text); }
  void DisplayDebugText(const char*) override {}

  std::string first;

 private:
  void keep(const char* text) {
    if (!first.empty() || text == nullptr) return;
    first = text;
    // "ERROR: In file.cxx, line 1\nClass (0x...): message"
    const std::size_t body = first.find("): ");
    if (body != std::string::npos) first = first.substr(body + 3);
    first = first.substr(0, first.find('\n')).substr(0, 200);
    if (first.empty()) first = "unknown error";
  }
};

}  // namespace

VtkErrors::VtkErrors() {
  window_mutex().lock();
  before_ = vtkOutputWindow::GetInstance();
  window_ = vtkSmartPointer<Catcher>::New();
  vtkOutputWindow::SetInstance(window_);
  // VTK also logs errors to the terminal.
  verbosity_ = vtkLogger::GetCurrentVerbosityCutoff();
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
}

VtkErrors::~VtkErrors() {
  vtkLogger::SetStderrVerbosity(static_cast<vtkLogger::Verbosity>(verbosity_));
  vtkOutputWindow::SetInstance(before_);
  window_mutex().unlock();
}

std::string VtkErrors::first() const { return static_cast<const Catcher*>(window_.Get())->first; }

}  // namespace dartcast
