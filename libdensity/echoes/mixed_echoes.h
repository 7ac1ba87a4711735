#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "libdensity/echoes/echo_columns.h"

namespace rayfield::density {

/// Echoes with a nearer one close on one side of their beam and a farther one on the other, by the gap between those
/// two along the beam: of each, how many lie between them (from a fifth to four fifths of the gap), as the mean of what
/// the beam met. Integers: any split of the echoes by place gives the same sums.
struct MixedEchoes {
  static constexpr int kGaps = 60;
  static constexpr double kGapStepM = 0.01;
  struct Count {
    std::int64_t all = 0, between = 0;
    bool operator==(const Count&) const = default;
  };
  std::array<Count, kGaps> gaps{};
  std::int64_t count() const;  ///< of echoes
  MixedEchoes& operator+=(const MixedEchoes& other);
  bool operator==(const MixedEchoes&) const = default;
};

/// Of the echoes of one place, of which up to `most` are looked at: those within a diameter of the beam (25 mm or more)
/// and 0.56 m along it, of beams from nearly the same direction (3.6°), to opposite sides (120° or more); the closest
/// two.
MixedEchoes find_mixed_echoes(const EchoColumns& echoes, std::size_t most);

/// What is believed of a range resolution.
struct BelievedResolution {
  double value_m = 0;
  double error_m = 0;  ///< standard error; 0: told
};

/// The range resolution: surfaces nearer to each other along the beam make one echo at their mean range, and an echo
/// lies between its neighbours; those farther apart do not. Likelihood of where the share that lies between falls, and
/// of what is usual, log-normal about 17 cm with 0.4 of the logarithm, from 4 to 43 cm: the likeliest, and the rms of
/// all from it (docs/beams.md, "How it is taken out").
BelievedResolution range_resolution_of(const MixedEchoes& mixed);

}  // namespace rayfield::density
