# SPDX-License-Identifier: Apache-2.0
"""The command line that validate and bench/accuracy have in common."""


def parse(parser, parts):
    """The options of a program that writes tables to a directory, by parts: `parts`
    [names] are those that were asked for, or all."""
    parser.add_argument("--quick", action="store_true", help="a small form")
    parser.add_argument("--backend", choices=("ref", "gpu"), default="ref")
    parser.add_argument("directory", metavar="DIRECTORY")
    parser.add_argument("parts", metavar="PART", nargs="*", default=[],
                        help=f"default: all of {' '.join(parts)}")
    options = parser.parse_args()
    for part in options.parts:
        if part not in parts:
            parser.error(f"there is no part {part}")
    options.parts = [part for part in parts if part in options.parts or not options.parts]
    return options
