// Arrays whose values particles take at their places, as numbers of user data. Not installed.
#pragma once

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

  /// Numbers of user data that they take, behind all others.
  [[nodiscard]] std::size_t size() const {
    std::size_t count = 0;
    for (const SampledField& f : fields_) count += f.names.size();
    return count;
  }
  void set(std::vector<SampledField> fields) { fields_ = std::move(fields); }
  /// As VectorField::hold().
  void hold(double begin, double end) {
    for (SampledField& f : fields_) f.field.hold(begin, end);
  }
  /// Writes the values at the particles' places now. Those that are held keep what they have.
  void take(ParticleSet& set, double time);

 private:
  const Environment& environment_;
  const std::vector<std::string>& data_names_;
  std::vector<SampledField> fields_;
};

}  // namespace dartcast
