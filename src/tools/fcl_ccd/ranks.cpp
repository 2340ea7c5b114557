// SPDX-License-Identifier: BSD-3-Clause
#include "ranks.h"

#include <cstdlib>
#include <cstring>

#include "stop_signal.h"

#ifdef FCL_CCD_USE_MPI
#include <mpi.h>

#include <algorithm>
#include <limits>
#include <list>
#include <thread>

#include "run_command.h"
#endif

namespace fcl_ccd {
namespace {

/// The variables in which OpenMPI's and MPICH's mpirun tell the number of ranks.
constexpr const char* kSizeVariables[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"};

std::string rankName(int rank) { return "rank " + std::to_string(rank); }

}  // namespace

void Ranks::requirePatience(const std::string& missing) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kPatience(500);
  if (stopSignal() == 0) return;
  if (!stopped_at_) stopped_at_ = Clock::now();
  if (Clock::now() - *stopped_at_ < kPatience) return;
  throw RankLost(std::string(strsignal(stopSignal())) + "; then " + missing +
                 " in half a second. If a rank died, mpirun tells which");
}

#ifdef FCL_CCD_USE_MPI
namespace {

void check(int error, int rank) {
  if (error == MPI_SUCCESS) return;
  char text[MPI_MAX_ERROR_STRING] = "";
  int size = 0;
  MPI_Error_string(error, text, &size);
  throw RankLost(rankName(rank) + " is lost: " + text);
}

int countOf(const std::string& bytes) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw std::runtime_error(
        "a step has more than 2 GiB of results, which is too much "
        "for a message. Run it without mpirun");
  return static_cast<int>(bytes.size());
}

/// @brief Waits until something holds. Ranks are some steps ahead, so that a pause delays
/// nothing. Shorter pauses would take processor time from the steps (3% with pauses of 20
/// us).
template <typename Holds>
void await(Ranks& ranks, int other, Holds holds) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  while (!holds()) {
    ranks.requirePatience(rankName(other) + " gave no answer");
    const Clock::duration pause = (Clock::now() - begin) / 8;
    std::this_thread::sleep_for(std::clamp<Clock::duration>(
        pause, std::chrono::microseconds(250), std::chrono::milliseconds(1)));
  }
}

bool isDone(MPI_Request& request, int rank) {
  int done = 0;
  check(MPI_Test(&request, &done, MPI_STATUS_IGNORE), rank);
  return done != 0;
}

}  // namespace

/// Posted messages, which live until they are received.
struct Ranks::Messages {
  struct Post {
    int to;
    std::string bytes;
    MPI_Request request;
  };
  std::list<Post> posts;
};

Ranks::Ranks() {
  const auto isSet = [](const char* name) { return std::getenv(name) != nullptr; };
  // PMIX_RANK is set by other starters, such as srun.
  if (std::none_of(std::begin(kSizeVariables), std::end(kSizeVariables), isSet) &&
      !isSet("PMIX_RANK"))
    return;
  int provided = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  messages_ = std::make_unique<Messages>();
}

Ranks::~Ranks() {
  if (messages_ == nullptr) return;
  if (in_exchange_) MPI_Abort(MPI_COMM_WORLD, kRankLost);
  MPI_Finalize();
}

std::string Ranks::name() const {
  char host[MPI_MAX_PROCESSOR_NAME] = "";
  int size = 0;
  MPI_Get_processor_name(host, &size);
  return rankName(rank_) + " on " + host;
}

void Ranks::endExchange() {
  for (Messages::Post& post : messages_->posts)
    await(*this, post.to, [&] { return isDone(post.request, post.to); });
  messages_->posts.clear();
  in_exchange_ = false;
}

void Ranks::send(int to, const std::string& bytes) {
  MPI_Request request;
  // Synchronous: a rank that is ahead of rank 0 does not fill its memory.
  check(
      MPI_Issend(bytes.data(), countOf(bytes), MPI_BYTE, to, 0, MPI_COMM_WORLD, &request),
      to);
  await(*this, to, [&] { return isDone(request, to); });
}

void Ranks::post(const std::string& bytes) {
  for (int to = 0; to < size_; ++to) {
    if (to == rank_) continue;
    Messages::Post& post = messages_->posts.emplace_back();
    post.to = to;
    post.bytes = bytes;
    check(MPI_Isend(post.bytes.data(), countOf(bytes), MPI_BYTE, to, 0, MPI_COMM_WORLD,
                    &post.request),
          to);
  }
}

bool Ranks::hasMessage(int from) {
  int found = 0;
  check(MPI_Iprobe(from, 0, MPI_COMM_WORLD, &found, MPI_STATUS_IGNORE), from);
  return found != 0;
}

std::string Ranks::receive(int from) {
  MPI_Message message = MPI_MESSAGE_NULL;
  MPI_Status status;
  await(*this, from, [&] {
    int found = 0;
    check(MPI_Improbe(from, 0, MPI_COMM_WORLD, &found, &message, &status), from);
    return found != 0;
  });
  int size = 0;
  MPI_Get_count(&status, MPI_BYTE, &size);
  std::string bytes(static_cast<std::size_t>(size), '\0');
  MPI_Request request;
  check(MPI_Imrecv(bytes.data(), size, MPI_BYTE, &message, &request), from);
  await(*this, from, [&] { return isDone(request, from); });
  return bytes;
}

#else

struct Ranks::Messages {};

Ranks::Ranks() {
  for (const char* name : kSizeVariables) {
    const char* size = std::getenv(name);
    if (size != nullptr && std::atoi(size) > 1)
      throw std::runtime_error(
          std::string(size) + " processes were started (" + name +
          "), but this fcl-ccd was built without MPI: each would do the whole run. Build "
          "it with FCL_CCD_BUILD_MPI=ON, or start one process");
  }
}

Ranks::~Ranks() = default;

std::string Ranks::name() const { return rankName(rank_); }

// There is no other rank.
void Ranks::endExchange() { in_exchange_ = false; }
void Ranks::send(int, const std::string&) {}
void Ranks::post(const std::string&) {}
bool Ranks::hasMessage(int) { return false; }
std::string Ranks::receive(int from) { throw RankLost("there is no " + rankName(from)); }
#endif

}  // namespace fcl_ccd
