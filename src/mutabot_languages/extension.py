"""What this package brings to mutabot."""

from __future__ import annotations

from mutabot.api.faults import Described, Extension

EXTENSION = Extension(
    interface=2,
    faults={"languages": "mutabot_languages.mutation.provider:LanguageFaults"},
    commands={
        "diff": Described(
            "mutabot_languages.mutation.command:diff",
            "Show mutants of robot programs as changes of their text.",
            before="operators",
        ),
        "export": Described(
            "mutabot_languages.mutation.command:export",
            "Write mutated robot programs for the maker's simulator.",
            before="operators",
        ),
    },
    languages={
        "urscript": "mutabot_languages.urscript.language:URSCRIPT",
        "rapid": "mutabot_languages.rapid.language:RAPID",
        "krl": "mutabot_languages.krl.language:KRL",
    },
)

#: what makes `mutabot init` a project of robot programs in these languages
STARTER = "mutabot_languages.starting.project:project"
