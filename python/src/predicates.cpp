// Binds dartcast/predicates.hpp. Signs are taken of single points, or of arrays of points at once.
#include "dartcast/predicates.hpp"

#include <algorithm>
#include <utility>

#include "bind.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::predicates {
namespace {

constexpr std::array<const char*, 4> point_names = {"a", "b", "c", "d"};

// Points in a call: one of them, or an array.
class PointArgument {
 public:
  PointArgument(const py::object& x, const char* name) {
    if (py::isinstance<py::array>(x) && py::reinterpret_borrow<py::array>(x).ndim() == 2) {
      many_ = vectors(x, name);
      is_one_ = false;
    } else {
      one_ = vector(x, name);
    }
  }
  [[nodiscard]] bool is_one() const { return is_one_; }
  [[nodiscard]] std::size_t size() const { return many_.size(); }
  const Vec3& operator[](std::size_t i) const { return is_one_ ? one_ : many_[i]; }

 private:
  Vec3 one_;
  std::span<const Vec3> many_;
  bool is_one_ = true;
};

// f of each row. Points that are given once are the same in all rows.
template <class Number, std::size_t N, class Function>
py::object for_points(const std::array<py::object, N>& given, const Function& f) {
  std::vector<PointArgument> points;
  bool all_one = true;
  std::size_t rows = 0;
  for (std::size_t i = 0; i < N; ++i) {
    points.emplace_back(given[i], point_names[i]);
    if (points[i].is_one()) continue;
    if (!all_one && points[i].size() != rows) {
      throw InvalidArgument(std::string(point_names[i]) + ": expected " + std::to_string(rows) +
                            " points, as in the arrays before it; got " + std::to_string(points[i].size()));
    }
    rows = points[i].size();
    all_one = false;
  }
  const auto at = [&](std::size_t row) {
    return [&]<std::size_t... I>(std::index_sequence<I...>) { return f(points[I][row]...); }
    (std::make_index_sequence<N>());
  };
  if (all_one) return py::cast(at(0));
  py::array_t<Number> values(static_cast<py::ssize_t>(rows));
  Number* value = values.mutable_data();
  const py::gil_scoped_release release;
  for (std::size_t i = 0; i < rows; ++i) value[i] = static_cast<Number>(at(i));
  return values;
}

template <class Number, class Result>
void bind_of_four(py::module_& m, const char* name, Result (*f)(const Vec3&, const Vec3&, const Vec3&, const Vec3&),
                  const char* more) {
  m.def(
      name,
      [f](const py::object& a, const py::object& b, const py::object& c, const py::object& d) {
        return for_points<Number, 4>({a, b, c, d}, f);
      },
      py::arg("a"), py::arg("b"), py::arg("c"), py::arg("d"), (std::string(doc(name)) + more).c_str());
}

template <class Number, class Result>
void bind_of_three(py::module_& m, const char* name, Result (*f)(const Vec3&, const Vec3&, const Vec3&),
                   const char* more) {
  m.def(
      name,
      [f](const py::object& a, const py::object& b, const py::object& c) {
        return for_points<Number, 3>({a, b, c}, f);
      },
      py::arg("a"), py::arg("b"), py::arg("c"), (std::string(doc(name)) + more).c_str());
}

void bind_signs(py::module_& m) {
  bind_enum<Sign>(m, "Sign",
                  {{"NEGATIVE", Sign::negative},
                   {"ZERO", Sign::zero},
                   {"POSITIVE", Sign::positive},
                   {"UNDECIDABLE", Sign::undecidable}});
  constexpr const char* signs =
      "\n\nEach point is three numbers, or all of them are arrays (n, 3), where single points count for all rows. "
      "Returns "
      "a Sign, or int8 (n,).";
  constexpr const char* values =
      "\n\nEach point is three numbers, or all of them are arrays (n, 3), where single points count for all rows. "
      "Returns "
      "a number, or float64 (n,).";
  bind_of_four<std::int8_t, Sign>(m, "orient3d", &orient3d, signs);
  bind_of_four<std::int8_t, Sign>(m, "orient3d_exact", &orient3d_exact, signs);
  bind_of_four<double, double>(m, "orient3d_value", &orient3d_value, values);
  bind_of_three<std::int8_t, Sign>(m, "orient2d", &orient2d, signs);
  bind_of_three<std::int8_t, Sign>(m, "orient2d_exact", &orient2d_exact, signs);
  bind_of_three<double, double>(m, "orient2d_value", &orient2d_value, values);
}

void bind_bounds(py::module_& m) {
  m.attr("SMALLEST_MAGNITUDE") = smallest_magnitude;
  m.attr("LARGEST_MAGNITUDE") = largest_magnitude;
  m.attr("DETERMINANT_ERROR") = determinant_error;
  m.attr("SMALLEST_EXTENT") = smallest_extent;
  m.attr("LARGEST_EXTENT") = largest_extent;
  m.attr("LARGEST_DECIDED_EXTENT") = largest_decided_extent;
  m.attr("PLANE_ERROR") = plane_error;
  m.def("are_extents", &are_extents, py::arg("e"), py::arg("largest"), doc("are_extents"));
  m.def("bound_holds", &bound_holds, py::arg("extent"), doc("bound_holds"));
  m.def("filter_applies", &filter_applies, py::arg("extent"), doc("filter_applies"));
  m.def("are_plane_extents", &are_plane_extents, py::arg("x"), py::arg("y"), py::arg("largest"),
        doc("are_plane_extents"));
  m.def("plane_bound_holds", &plane_bound_holds, py::arg("x"), py::arg("y"), doc("plane_bound_holds"));
  m.def("plane_filter_applies", &plane_filter_applies, py::arg("x"), py::arg("y"), doc("plane_filter_applies"));
  m.def(
      "extent_of",
      [](const py::object& x) {
        const auto all = vectors(x, "vectors");
        if (all.empty()) throw InvalidArgument("vectors: expected at least one");
        Vec3 extent;
        for (const Vec3& v : all) extent = extent_of(extent, v);
        return extent;
      },
      py::arg("vectors"), (std::string(doc("extent_of")) + "\n\nvectors: float64 (n, 3).").c_str());
  m.def(
      "rounds_nothing",
      [](const Vec3& extent, const py::object& x) {
        const auto all = vectors(x, "points");
        return std::all_of(all.begin(), all.end(), [&](const Vec3& p) { return rounds_nothing(extent, p); });
      },
      py::arg("extent"), py::arg("points"),
      (std::string(doc("rounds_nothing")) + "\n\npoints: float64 (n, 3).").c_str());
}

void bind_ranges(py::module_& m) {
  m.def(
      "in_exact_range",
      [](const py::object& p) { return for_points<bool, 1>({p}, [](const Vec3& x) { return in_exact_range(x); }); },
      py::arg("p"), (std::string(doc("in_exact_range")) + "\n\nOf an array (n, 3): bool (n,).").c_str());
  m.def(
      "flushed",
      [](const py::object& x) -> py::object {
        const PointArgument points(x, "x");
        if (points.is_one()) return array_of(flushed(points[0]));
        std::vector<Vec3> all(points.size());
        for (std::size_t i = 0; i < all.size(); ++i) all[i] = flushed(points[i]);
        return array_of(std::span<const Vec3>(all));
      },
      py::arg("x"), (std::string(doc("flushed")) + "\n\nx: three numbers, or an array (n, 3).").c_str());
}

void expect_range(std::initializer_list<Vec3> points) {
  if (!std::all_of(points.begin(), points.end(), in_exact_range))
    throw InvalidArgument("a point is not finite, or has a coordinate above 2^300 in magnitude");
}

template <class Perturbation>
Perturbation perturbation(const Vec3& p, const py::object& opposite, std::size_t most) {
  const auto points = vectors(opposite, "opposite");
  if (points.size() > most)
    throw InvalidArgument("opposite: expected at most " + std::to_string(most) + " points; got " +
                          std::to_string(points.size()));
  expect_range({p});
  for (const Vec3& x : points) expect_range({x});
  return Perturbation(p, points);
}

void bind_perturbations(py::module_& m) {
  py::class_<SymbolicPerturbation>(m, "SymbolicPerturbation", doc("SymbolicPerturbation"))
      .def(py::init([](const Vec3& p, const py::object& opposite) {
             return perturbation<SymbolicPerturbation>(p, opposite, 3);
           }),
           py::arg("p"), py::arg("opposite"), doc("SymbolicPerturbation::SymbolicPerturbation"))
      .def(
          "of_line",
          [](const SymbolicPerturbation& s, const Vec3& a, const Vec3& b, const Vec3& q) {
            expect_range({a, b, q});
            return s.of_line(a, b, q);
          },
          py::arg("a"), py::arg("b"), py::arg("q"), doc("SymbolicPerturbation::of_line"));
  py::class_<PlanarSymbolicPerturbation>(m, "PlanarSymbolicPerturbation", doc("PlanarSymbolicPerturbation"))
      .def(py::init([](const Vec3& p, const py::object& opposite) {
             return perturbation<PlanarSymbolicPerturbation>(p, opposite, 2);
           }),
           py::arg("p"), py::arg("opposite"), doc("PlanarSymbolicPerturbation::PlanarSymbolicPerturbation"))
      .def(
          "of_line",
          [](const PlanarSymbolicPerturbation& s, const Vec3& q0) {
            expect_range({q0});
            return s.of_line(q0);
          },
          py::arg("q0"), doc("PlanarSymbolicPerturbation::of_line"));
}

}  // namespace

void bind(py::module_& m) {
  bind_signs(m);
  bind_bounds(m);
  bind_ranges(m);
  bind_perturbations(m);
}

}  // namespace dartcast::python::predicates
