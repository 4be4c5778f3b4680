// A page with the viewer on it. Not installed.
#pragma once

#include <string>

#include "report/viewer_data.hpp"

namespace dartcast {

struct ViewerPage {
  std::string title;     ///< plain text
  std::string subtitle;  ///< plain text
  std::string body;      ///< HTML, below the view
};

/// The element of a page that holds what the viewer shows, in JSON.
std::string json_script(const std::string& json);

std::string viewer_page(const ViewerPage& page, const ViewerData& data);

}  // namespace dartcast
