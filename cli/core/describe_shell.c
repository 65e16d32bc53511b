/* Prints completions for bash and zsh. */
#include "describe.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* 1 where a command's first argument is a choice: "bash|zsh" in its usage line, or KIND; 0 where it is a file. */
static int has_choices(const cli_command *command) {
    return describe_choice(command) || strncmp(command->arguments, "KIND ", 5) == 0;
}

static void put_choices(const cli_command *command, char between) {
    const int length = describe_choice(command);
    if (!length && has_choices(command)) describe_kinds((const char[2]){between, 0});
    for (int i = 0; i < length; i++) putchar(command->arguments[i] == '|' ? between : command->arguments[i]);
}

/* -- bash ----------------------------------------------------------------------------------------------------------- */

/* Prints names for compgen -W. put_pattern: "--output|-o" for a case. */
static void put_names(const cli_option *o) { o->letter ? printf("%s -%c ", o->name, o->letter) : printf("%s ", o->name); }

static void put_pattern(const cli_option *o) { o->letter ? printf("%s|-%c", o->name, o->letter) : printf("%s", o->name); }

static void bash_value(const cli_option *o) {
    static const char *const actions[] = {"_tides_none", "_tides_files",   "_tides_folders",
                                          "_tides_keys", "_tides_devices", "_tides_formats"};
    if (!o->argument) return;
    fputs("        ", stdout);
    put_pattern(o);
    const int32_t action = describe_argument(o->argument);
    fputs(") ", stdout);
    if (action == DESCRIBE_WORDS || action == DESCRIBE_LIST) {
        fputs(action == DESCRIBE_LIST ? "_tides_list '" : "_tides_words '", stdout);
        describe_words(o, " ");
        fputs("'; return ;;\n", stdout);
    } else {
        printf("%s; return ;;\n", actions[action]);
    }
}

void describe_bash_command(const cli_command *command, const cli_option *options) {
    cli_common common;
    cli_option shared[CLI_COMMON_OPTIONS];
    cli_common_options(shared, &common);
    printf("    %s)\n        options='", command->name);
    for (const cli_option *o = options; o->name; o++) put_names(o);
    for (size_t i = 0; i < CLI_COMMON_OPTIONS; i++) put_names(&shared[i]);
    fputs("'\n        choices='", stdout);
    put_choices(command, ' ');
    fputs("'\n        case $before in\n", stdout);
    for (const cli_option *o = options; o->name; o++) bash_value(o);
    for (size_t i = 0; i < CLI_COMMON_OPTIONS; i++) bash_value(&shared[i]);
    fputs("        esac ;;\n", stdout);
}

/* Completes keys' values. bash takes '=' as a word of its own: "--set", "image.rules", "=", "smo". */
static void bash_choices_of_keys(void) {
    size_t count;
    const tides_param *rows = tides_params(&count);
    fputs("_tides_values() {\n    local values=\n    case $1 in\n", stdout);
    for (size_t i = 0; i < count; i++) {
        if (!rows[i].choices && rows[i].type != TIDES_PARAM_BOOLEAN) continue;
        printf("    %s) values='", rows[i].key);
        for (const char *at = rows[i].choices ? rows[i].choices : "true|false"; *at; at++) putchar(*at == '|' ? ' ' : *at);
        fputs("' ;;\n", stdout);
    }
    fputs("    sensor.preset) values='", stdout);
    describe_presets(" ");
    fputs("' ;;\n    *.file) compopt -o filenames; COMPREPLY=($(compgen -f -- \"$word\")); return ;;\n    esac\n"
          "    COMPREPLY=($(compgen -W \"$values\" -- \"$word\"))\n}\n",
          stdout);
}

void describe_bash_begin(const cli_command *commands, size_t count) {
    fputs("# bash completion of tides; made by tides help --bash\n"
          "_tides_none() { :; }\n"
          "_tides_files() { compopt -o filenames; COMPREPLY=($(compgen -f -- \"$word\")); }\n"
          "_tides_folders() { compopt -o filenames; COMPREPLY=($(compgen -d -- \"$word\")); }\n"
          "_tides_words() { COMPREPLY=($(compgen -W \"$1\" -- \"$word\")); }\n"
          "_tides_list() {\n    local head=\n    case $word in *,*) head=${word%,*}, ;; esac\n    compopt -o nospace\n"
          "    COMPREPLY=($(compgen -P \"$head\" -W \"$1\" -- \"${word##*,}\"))\n}\n"
          "_tides_devices() { COMPREPLY=($(compgen -W '",
          stdout);
    describe_devices(" ");
    fputs("' -- \"$word\")); }\n_tides_formats() { COMPREPLY=($(compgen -W '", stdout);
    describe_formats(" ");
    fputs("' -- \"$word\")); }\n_tides_keys() {\n    compopt -o nospace\n    COMPREPLY=($(compgen -W '", stdout);
    describe_keys("=", " ");
    fputs("' -- \"$word\"))\n}\n", stdout);
    bash_choices_of_keys();
    fputs("_tides() {\n    local IFS=$' \\t\\n' word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} options= "
          "choices=\n"
          "    local at=$COMP_CWORD\n    COMPREPLY=()\n    [ \"$word\" = = ] && { word=; at=$((at + 1)); }\n"
          "    if [ \"${COMP_WORDS[at-1]}\" = = ] && [ \"$at\" -gt 3 ] && [ \"${COMP_WORDS[at-3]}\" = --set ]; then\n"
          "        _tides_values \"${COMP_WORDS[at-2]}\"\n        return\n    fi\n"
          "    if [ \"$COMP_CWORD\" = 1 ]; then\n        COMPREPLY=($(compgen -W '",
          stdout);
    for (size_t i = 0; i < count; i++) printf("%s ", commands[i].name);
    fputs("help --help --version' -- \"$word\"))\n        return\n    fi\n    case ${COMP_WORDS[1]} in\n    help)\n        "
          "choices='",
          stdout);
    for (size_t i = 0; i < count; i++) printf("%s ", commands[i].name);
    fputs("'\n        options='--man --bash --zsh' ;;\n", stdout);
}

void describe_bash_end(void) {
    fputs("    *) return ;;\n    esac\n"
          "    if [ \"${word:0:1}\" = - ]; then\n        COMPREPLY=($(compgen -W \"$options\" -- \"$word\"))\n"
          "    elif [ -n \"$choices\" ]; then\n        COMPREPLY=($(compgen -W \"$choices\" -- \"$word\"))\n"
          "    else\n        _tides_files\n    fi\n}\ncomplete -F _tides tides\n",
          stdout);
}

/* -- zsh ------------------------------------------------------------------------------------------------------------ */

/* Prints a text within '...[...]' of _arguments, where quotes, brackets and colons must be escaped. */
static void zsh_text(const char *text) {
    for (; *text; text++) {
        if (*text == '\'')
            fputs("'\\''", stdout);
        else if (strchr("[]:\\", *text))
            printf("\\%c", *text);
        else
            putchar(*text);
    }
}

static void zsh_action(const cli_option *o) {
    static const char *const actions[] = {" ", "_files", "_files -/", "_tides_keys", "_tides_devices", "_tides_formats"};
    const int32_t action = describe_argument(o->argument);
    if (action != DESCRIBE_WORDS && action != DESCRIBE_LIST) {
        printf(":%s", actions[action]);
        return;
    }
    fputs(action == DESCRIBE_LIST ? ":_values -s , name " : ":(", stdout);
    describe_words(o, " ");
    if (action == DESCRIBE_WORDS) putchar(')');
}

static void zsh_option(const cli_option *o) {
    fputs(" \\\n            ", stdout);
    if (o->letter)
        printf("{-%c,%s}'[", o->letter, o->name);
    else
        printf("'%s%s[", o->list ? "*" : "", o->name); /* '*': an option that may be repeated */
    zsh_text(o->help);
    putchar(']');
    if (o->argument) {
        putchar(':');
        zsh_text(o->argument);
        zsh_action(o);
    }
    putchar('\'');
}

void describe_zsh_command(const cli_command *command, const cli_option *options) {
    cli_common common;
    cli_option shared[CLI_COMMON_OPTIONS];
    cli_common_options(shared, &common);
    printf("    %s)\n        _arguments -s", command->name);
    for (const cli_option *o = options; o->name; o++) zsh_option(o);
    for (size_t i = 0; i < CLI_COMMON_OPTIONS; i++) zsh_option(&shared[i]);
    for (int32_t i = 0; i < abs(command->positionals); i++) {
        if (i > 0 || !has_choices(command)) {
            printf(" \\\n            '%d:file:_files'", (int)i + 1);
        } else {
            fputs(" \\\n            '1:what:(", stdout);
            put_choices(command, ' ');
            fputs(")'", stdout);
        }
    }
    fputs(" ;;\n", stdout);
}

void describe_zsh_begin(const cli_command *commands, size_t count) {
    fputs("#compdef tides\n# zsh completion of tides; made by tides help --zsh\n_tides_devices() { compadd -- ", stdout);
    describe_devices(" ");
    fputs(" }\n_tides_formats() { compadd -- ", stdout);
    describe_formats(" ");
    fputs(" }\n_tides_keys() { compadd -S '' -- ", stdout);
    describe_keys("=", " ");
    fputs(" }\n_tides() {\n    local -a commands\n    commands=(\n", stdout);
    for (size_t i = 0; i < count; i++) {
        printf("        '%s:", commands[i].name);
        zsh_text(commands[i].summary);
        fputs("'\n", stdout);
    }
    fputs("        'help:Explain a command.'\n    )\n    if (( CURRENT == 2 )); then\n        _describe command commands\n"
          "        return\n    fi\n    shift words\n    (( CURRENT-- ))\n    case $words[1] in\n"
          "    help) _describe command commands ;;\n",
          stdout);
}

void describe_zsh_end(void) {
    fputs("    esac\n}\nif [ \"$funcstack[1]\" = _tides ]; then _tides \"$@\"; else compdef _tides tides; fi\n", stdout);
}
