// SPDX-License-Identifier: BSD-3-Clause
//
// A family of generated cases with a reference of its own. A case is a function of its
// seed. To add a family, write a file with a `const RegisteredFamily` and name the file
// in CMake.
#ifndef FCL_FUZZ_FAMILY_H
#define FCL_FUZZ_FAMILY_H

#include <chrono>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace fcl {
namespace test {

/// @brief What one case found.
struct Outcome {
  /// More than one where variants of a case share their reference.
  std::uint64_t cases{1};
  /// Contacts that the reference has, or pairs in contact.
  std::uint64_t contacts{0};
  /// Contacts that the library lacks.
  std::uint64_t missed{0};
  /// Times after the true first time.
  std::uint64_t late{0};
  /// Contacts that the library invents.
  std::uint64_t invented{0};
  /// Times more than toc_err before the true first time.
  std::uint64_t early{0};
  /// Exceptions that the library threw.
  std::uint64_t exceptions{0};
  /// The slowest call of the library.
  double slowest_us{0};
  /// A hash of the library's answers.
  std::uint64_t digest{0};
  /// Empty if nothing is wrong; otherwise what is, and the case as the body of a test.
  std::string complaint;

  /// @brief Counts a fault. The first one is described.
  void blame(std::uint64_t Outcome::*count, const std::string& what) {
    ++(this->*count);
    if (complaint.empty()) complaint = what;
  }
  bool isRight() const { return complaint.empty(); }

  void addToDigest(std::uint64_t bits) {
    for (int i = 0; i < 64; i += 8)
      digest = (digest ^ (bits >> i & 255)) * 0x100000001b3U;
  }
  void addToDigest(double x) {
    std::uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    addToDigest(bits);
  }

  /// @brief Calls the library and takes its time.
  template <typename Call>
  auto timed(Call&& call) {
    const Stopwatch watch(slowest_us);
    return call();
  }

 private:
  class Stopwatch {
   public:
    using Clock = std::chrono::steady_clock;
    explicit Stopwatch(double& slowest_us) : slowest_us_(slowest_us) {}
    Stopwatch(const Stopwatch&) = delete;
    Stopwatch& operator=(const Stopwatch&) = delete;
    ~Stopwatch() {
      const double us =
          std::chrono::duration<double, std::micro>(Clock::now() - begin_).count();
      if (us > slowest_us_) slowest_us_ = us;
    }

   private:
    double& slowest_us_;
    Clock::time_point begin_{Clock::now()};
  };
};

struct Family {
  const char* name;
  Outcome (*run)(std::uint64_t seed);
  /// How many cases there are for each one that is asked for: cheap ones are many.
  std::uint64_t share;
};

/// @brief All families, by name.
std::vector<Family> families();

struct RegisteredFamily {
  RegisteredFamily(const char* name, Outcome (*run)(std::uint64_t seed),
                   std::uint64_t share = 1);
};

/// @brief The seed of a case.
std::uint64_t caseSeed(std::uint64_t seed, const char* family, std::uint64_t index);

/// @brief A fault put into the library's answers to see that the families report it.
enum class PlantedFault { kNone, kDropped, kLate };
PlantedFault plantedFault();
void plantFault(PlantedFault fault);

/// @brief Puts the planted fault into a list of contacts with toc_lo and toc_hi.
template <typename Contacts>
void applyPlantedFault(Contacts& contacts) {
  if (plantedFault() == PlantedFault::kNone || contacts.empty()) return;
  if (plantedFault() == PlantedFault::kDropped) {
    contacts.pop_back();
    return;
  }
  constexpr double kShift = 0.01;
  for (auto& contact : contacts) {
    contact.toc_lo += kShift;
    contact.toc_hi += kShift;
  }
}

}  // namespace test
}  // namespace fcl

#endif
