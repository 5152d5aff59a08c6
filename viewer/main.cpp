// mdview: the viewer's main. Errors that end the program are caught here, once.
#include <cstdlib>
#include <exception>
#include <iostream>

#include "common/base/error.h"
#include "common/base/isa.h"
#include "common/base/parallel.h"
#include "common/base/text.h"
#include "formats/files/mapped_file.h"
#include "viewer/app/app.h"
#include "viewer/options.h"

int main(int argc, char** argv) {
  mdk::name_lost_mappings();
  try {
    const auto options = mdk::parse_options(argc, argv, std::cout);
    if (!options) return EXIT_SUCCESS;
    if (!options->isa.empty()) mdk::limit_isa(options->isa);
    const mdk::ThreadLimit threads(options->threads);
    mdk::App app(*options);
    return app.run();
  } catch (const mdk::Error& error) {
    std::cerr << "mdview: " << mdk::printable_line(error.what()) << "\n";
    return error.exit_status();
  } catch (const std::exception& fault) {
    std::cerr << "mdview: internal fault, please report: " << fault.what() << "\n";
    return static_cast<int>(mdk::ErrorCode::kInternal);
  }
}
