// Arrays whose values particles take at their places, as numbers of user data. Not installed.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/environment.hpp"
#include "dartcast/vector_field.hpp"
#include "simulation/followers.hpp"
#include "simulation/particle_set.hpp"

namespace dartcast {

/// Up to three components of an array.
struct SampledField {
  VectorField field;
  std::vector<std::string> names;  ///< of its components' numbers
  /// A number that a component is integrated in.
  struct Integral {
    std::string name;
    std::size_t component = 0;
  };
  std::vector<Integral> integrals = {};
};

class SampledFields {
 public:
  /// All outlive it. `data_names`: those of the particles' numbers.
  SampledFields(const Environment& environment, Followers& followers, const std::vector<std::string>& data_names)
      : environment_(environment), data_names_(data_names) {
    followers.add([this](const ComplexEditReport& edit, OrphanPolicy /*orphaned*/) {
      for (SampledField& f : fields_) f.field.update_after_edit(edit, environment_.complex());
    });
  }

  struct Component {
    const VectorField* field = nullptr;  ///< null: there is none
    std::size_t number = 0;
  };
  /// The component of this name.
  [[nodiscard]] Component component(const std::string& name) const;
  [[nodiscard]] bool integrate() const {
    return std::any_of(fields_.begin(), fields_.end(), [](const SampledField& f) { return !f.integrals.empty(); });
  }
  /// A component at a place, and its gradient there.
  struct Value {
    double value = 0.0;
    Vec3 gradient;  ///< of the particle's simplex; 0 in a sliver
  };
  /// Never below 0. `moving`: the state is from before the last move. Precondition: the field is at points.
  [[nodiscard]] Value at(const Component& of, const ParticleState& state, bool moving) const;
  void set(std::vector<SampledField> fields) { fields_ = std::move(fields); }
  /// As VectorField::hold().
  void hold(double begin, double end) {
    for (SampledField& f : fields_) f.field.hold(begin, end);
  }
  /// Writes the values at the particles' places now, and adds their integrals over the `duration` before. Those that are
  /// held keep their values.
  void take(ParticleSet& set, double time, double duration);

 private:
  [[nodiscard]] std::size_t column(const std::string& name) const;

  const Environment& environment_;
  const std::vector<std::string>& data_names_;
  std::vector<SampledField> fields_;
};

}  // namespace dartcast
