#include "flotsam/io/plot.hpp"

#include "flotsam/core/contracts.hpp"
#include "flotsam/io/output_error.hpp"
#include "io/gnuplot_script.hpp"
#include "io/output_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <system_error>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace flotsam {

namespace fs = std::filesystem;

namespace {

constexpr const char* kMissing = "there is no gnuplot; install the package gnuplot-nox";

void require_finite(const std::vector<double>& numbers)
{
    require(std::all_of(numbers.begin(), numbers.end(), [](double v) { return std::isfinite(v); }),
            "numbers to plot must be finite");
}

void require_valid(const Plot& plot)
{
    require(!plot.series.empty(), "a plot must have at least one series");
    for (const int pixels : {plot.width, plot.height})
        require(pixels >= 100 && pixels <= 10000, "a plot must be 100 to 10000 pixels wide and high", pixels);
    for (const PlotSeries& series : plot.series) {
        const std::size_t upper = series.style == PlotSeries::Style::band ? series.x.size() : 0;
        require(!series.x.empty(), "a series must have at least one point");
        require(series.y.size() == series.x.size() && series.y_upper.size() == upper,
                "a series must have one y per x, and a band one y_upper per x");
        for (const auto* numbers : {&series.x, &series.y, &series.y_upper}) require_finite(*numbers);
    }
}

std::string terminal_for(const fs::path& file)
{
    const bool is_png = file.extension() == ".png", is_svg = file.extension() == ".svg";
    require(is_png || is_svg, "the name of a plot's file must end in .png or .svg", file.string());
    return is_png ? "pngcairo" : "svg";
}

/// A file beside the plot that is gone in the end.
struct Aside {
    fs::path path;

    explicit Aside(fs::path where) : path(std::move(where)) {}
    ~Aside()
    {
        std::error_code ignored;
        fs::remove(path, ignored);
    }
    Aside(const Aside&) = delete;
    Aside& operator=(const Aside&) = delete;
};

std::string system_words(int error)
{
    return std::generic_category().message(error);
}

/// Its exit code, 127 where there is no such program. What it prints goes to `log`. Throws OutputError naming `file`.
int run_gnuplot(const fs::path& script, const fs::path& log, const fs::path& file)
{
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
    std::string program = "gnuplot", own_settings = "-d", argument = script.string();
    const std::array<char*, 4> arguments = {program.data(), own_settings.data(), argument.data(), nullptr};
    pid_t child = 0;
    const int error = ::posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error == ENOENT) return 127;
    if (error != 0)
        throw OutputError("cannot draw " + file.string() + ": gnuplot does not start: " + system_words(error));
    int status = 0;
    while (::waitpid(child, &status, 0) < 0)
        if (errno != EINTR) throw OutputError("cannot draw " + file.string() + ": " + system_words(errno));
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

/// What gnuplot complained about: the last line that it printed.
std::string last_line(const fs::path& log)
{
    std::ifstream stream(log);
    std::string last;
    for (std::string line; std::getline(stream, line);)
        if (!line.empty()) last = line;
    return last.empty() ? "it does not say why" : last;
}

} // namespace

void write_plot(const fs::path& file, const Plot& plot)
{
    require_valid(plot);
    const std::string terminal = terminal_for(file);
    const fs::path whole = fs::absolute(file); // gnuplot takes a name that begins with | for a program
    const Aside script(whole.string() + ".gnuplot"), log(whole.string() + ".log"), partial(whole.string() + ".partial");
    OutputFile stream(script.path);
    stream.write(gnuplot_script(plot, terminal, partial.path.string()));
    stream.close();
    const int code = run_gnuplot(script.path, log.path, file);
    if (code == 127) throw OutputError("cannot draw " + file.string() + ": " + kMissing);
    if (code != 0) throw OutputError("cannot draw " + file.string() + ": gnuplot failed: " + last_line(log.path));
    std::error_code error;
    fs::rename(partial.path, whole, error);
    if (error) throw OutputError("cannot write " + file.string() + ": " + error.message());
}

} // namespace flotsam
