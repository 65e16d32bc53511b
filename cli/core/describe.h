/* Man pages and shell completions, made from the tables that the parser and the run file reader use. */
#ifndef CLI_DESCRIBE_H
#define CLI_DESCRIBE_H

#include "cli.h"

/* Kinds of values of an option, by their word in the usage line. */
enum {
    DESCRIBE_NOTHING = 0,
    DESCRIBE_FILE,
    DESCRIBE_FOLDER,
    DESCRIBE_KEY,
    DESCRIBE_DEVICE,
    DESCRIBE_FORMAT,
    DESCRIBE_WORDS,
    DESCRIBE_LIST
};
int32_t describe_argument(const char *argument); /* describe_words.c: this function and those below */
/* Prints the words of DESCRIBE_WORDS, a choice ("frame|xyt") or a table's names (LAYOUT), or of DESCRIBE_LIST, with which the
 * option's help begins ("a,b,c: ..."), separated by `between`. */
void describe_words(const cli_option *option, const char *between);
/* Prints the names of presets. describe_kinds: of kinds of made scenes. */
void describe_presets(const char *between);
void describe_kinds(const char *between);
/* The length of a command's first argument where that is a choice, such as "accuracy|ablation|image", else 0. */
int describe_choice(const cli_command *command);
/* Prints common words of TIDES_DEVICE, the event formats that can be written, or the keys of run files, with `between` after
 * each and `after` before it. */
void describe_devices(const char *between);
void describe_formats(const char *between);
void describe_keys(const char *after, const char *between);

/* describe_man.c: man pages of one command, of the tool, and of the run file. */
void describe_man_command(const cli_command *command, const cli_option *options);
void describe_man_tool(const cli_command *commands, size_t count);
void describe_man_run(void);

/* describe_shell.c: completions for one command (a part of a case), and the text around them. */
void describe_bash_command(const cli_command *command, const cli_option *options);
void describe_bash_begin(const cli_command *commands, size_t count);
void describe_bash_end(void);
void describe_zsh_command(const cli_command *command, const cli_option *options);
void describe_zsh_begin(const cli_command *commands, size_t count);
void describe_zsh_end(void);

#endif
