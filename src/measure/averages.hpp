// Running means and co-moments: everything that a measurement remembers, in plain arrays.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace barchan {

/// The memory of all instruments of a run; what a checkpoint has to hold. Rows of all instruments follow one another.
struct Accumulators {
  std::vector<std::int64_t> due;      // by instrument: number of the next sample
  std::vector<std::int64_t> moments;  // by instrument: samples taken into the averages
  std::vector<std::int64_t> count;    // by row: values taken into mean and comoment
  std::vector<double> fraction;       // by row: sum of the volume fractions of all moments
  std::vector<double> flux;           // kg/m2/s, by row with a flux and axis: sum of the mass fluxes of all moments
  std::vector<double> mean;           // by row, quantity
  std::vector<double> comoment;       // by row, pair of quantities j <= i at i (i + 1)/2 + j: sum of dq_i dq_j
};

/// One row of the accumulators.
class Average {
 public:
  Average(Accumulators& a, std::size_t row, std::size_t first_mean, std::size_t first_comoment, std::size_t quantities)
      : count_(&a.count[row]),
        mean_(a.mean.data() + first_mean, quantities),
        comoment_(a.comoment.data() + first_comoment, quantities * (quantities + 1) / 2) {}

  /// Takes a sample in (Welford 1962): nothing is lost to cancellation when fluctuations are small beside the mean.
  void add(std::span<const double> sample) {
    ++*count_;
    const double share = 1.0 / static_cast<double>(*count_);
    // With d = q - old mean: mean += d/n, comoment_ij += d_i d_j (n - 1)/n.
    for (std::size_t i = 0, k = 0; i < mean_.size(); ++i)
      for (std::size_t j = 0; j <= i; ++j, ++k)
        comoment_[k] += (sample[i] - mean_[i]) * (sample[j] - mean_[j]) * (1.0 - share);
    for (std::size_t i = 0; i < mean_.size(); ++i) mean_[i] += share * (sample[i] - mean_[i]);
  }

  std::int64_t count() const { return *count_; }
  double mean(std::size_t i) const { return mean_[i]; }
  /// <q_i' q_j'>; 0 without samples.
  double covariance(std::size_t i, std::size_t j) const {
    const std::size_t k = i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i;
    return *count_ > 0 ? comoment_[k] / static_cast<double>(*count_) : 0.0;
  }

 private:
  std::int64_t* count_;
  std::span<double> mean_, comoment_;
};

}  // namespace barchan
