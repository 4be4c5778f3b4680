// Binds dartcast/contact.hpp. Lists of contacts are structured arrays; single ones are records.
#include "dartcast/contact.hpp"

#include "bind.hpp"
#include "support/python.hpp"
#include "support/rows.hpp"

namespace py = pybind11;

namespace dartcast::python::contact {

void bind(py::module_& m) {
  register_rows();
  m.attr("SHARE_TOGETHER") = share_together;
  m.attr("ALONG_SHARE") = along_share;
  Record<WallHit>(m, "WallHit")
      .field("face", &WallHit::face)
      .field("triangle", &WallHit::triangle)
      .field("patch", &WallHit::patch)
      .field("normal", &WallHit::normal)
      .finish();
  Record<Contact>(m, "Contact")
      .field("particle", &Contact::particle)
      .field("kind", &Contact::kind)
      .field("dart", &Contact::dart)
      .field("first_wall", &Contact::first_wall)
      .field("wall_count", &Contact::wall_count)
      .field("earlier", &Contact::earlier)
      .field("together", &Contact::together)
      .field("last", &Contact::last)
      .field("time_of_impact", &Contact::time_of_impact)
      .field("point", &Contact::point)
      .field("wall_displacement", &Contact::wall_displacement)
      .field("displacement", &Contact::displacement)
      .field("unused", &Contact::unused)
      .finish();
  Record<AfterContact>(m, "AfterContact")
      .field("displacement", &AfterContact::displacement)
      .field("along", &AfterContact::along)
      .finish();
}

}  // namespace dartcast::python::contact
