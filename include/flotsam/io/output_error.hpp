#pragma once

#include <stdexcept>

namespace flotsam {

/// A result could not be written; what() is one sentence that names the file and the system's reason (disk full, not
/// allowed, ...).
class OutputError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

} // namespace flotsam
