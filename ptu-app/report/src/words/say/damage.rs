//! Findings of a check of the history, and their remedies, in the words of a window: without commands, and in
//! Korean.

use fault_db::{Advice, ProblemKind};
use ptu_runs::words::noun;

use super::super::{Language, Words};

impl Words {
    /// The kind of a problem that a check found.
    pub fn problem_kind(&self, kind: ProblemKind) -> &'static str {
        use ProblemKind as K;
        self.choose(match kind {
            K::Integrity => ["integrity", "손상"],
            K::Schema => ["schema", "구조"],
            K::ForeignKey => ["foreign key", "참조"],
            K::Count => ["count", "횟수"],
            K::Fault => ["fault", "고장"],
            K::Trace => ["trace", "신호 기록"],
            K::Recording => ["recording", "기록"],
            K::Seal => ["seal", "봉인"],
            K::Derived => ["derived", "집계"],
        })
    }

    /// The next move after a problem.
    #[rustfmt::skip]
    pub fn advice(&self, advice: Advice) -> &'static str {
        use Advice as A;
        self.choose(match advice {
            A::FromBackup => ["keep this file as it is and go on with a backup; other laptops and the server may have what was recorded since", "이 파일을 그대로 보관하고 백업으로 계속하십시오. 그 후의 기록은 다른 노트북이나 서버에 있을 수 있습니다"],
            A::Lost => ["it cannot be brought back here; a backup, another laptop or the server may have it", "여기서는 복구할 수 없습니다. 백업, 다른 노트북 또는 서버에 있을 수 있습니다"],
            A::Altered => ["somebody has changed the file by hand: what no line names can still be trusted as far as its seal is the one on a test sheet, in a backup or on the server; this finding stays", "파일이 임의로 변경되었습니다. 위에 없는 내용은 봉인이 성적서, 백업 또는 서버의 것과 같으면 믿을 수 있습니다. 이 결과는 없앨 수 없습니다"],
            A::ForeignObject => ["nothing is written to such a file; keep a copy of it as it is, then go on with a backup, or take out by hand what is not of this program and check it again", "이런 파일에는 기록하지 않습니다. 사본을 그대로 보관하고 백업으로 계속하거나, 이 프로그램의 것이 아닌 내용을 제거한 후 다시 검사하십시오"],
            A::Rebuild => ["a row may have been changed by hand: compare the file with a backup or the server, and ask who looks after the history", "행이 임의로 변경되었을 수 있습니다. 먼저 백업이나 서버와 비교하고, 이력 담당자에게 문의하십시오"],
            A::SealsOfServer => ["hold it against the test sheet or the laptop that recorded it; who owns the tables has changed them by hand", "성적서나 기록한 노트북과 비교하십시오. 테이블 소유자가 임의로 변경했습니다"],
            A::GuardsOfServer => ["let who looks after the server find out who took them off, and put them back from a backup", "서버 담당자가 누가 껐는지 확인하고 백업에서 복구해야 합니다"],
        })
    }

    /// A row that was refused, by its table and id.
    pub fn stored_row(&self, row: &str) -> String {
        match (self.language, row.rsplit_once(' ')) {
            (Language::Korean, Some((table, id))) => format!("{} {id}", noun(table)),
            _ => row.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fault_db::{Damage, Derived};

    /// Goal: advice that names a command of the terminal, or stays English, fails.
    #[test]
    fn advice_and_kinds_are_told_without_commands_and_in_korean() {
        let [english, korean] = Language::ALL.map(Language::words);
        for advice in Advice::ALL {
            assert!(!english.advice(*advice).contains('`'), "{advice}");
            assert!(!is_english(korean.advice(*advice)), "{advice}");
        }
        for kind in ProblemKind::ALL {
            assert!(!is_english(korean.problem_kind(*kind)), "{kind}");
        }
        for derived in Derived::ALL {
            let damage = korean.trouble(&Damage::Miscounted(7, *derived));
            assert!(!is_english(&damage), "{damage}");
        }
    }

    fn is_english(text: &str) -> bool {
        text.bytes().any(|byte| byte.is_ascii_lowercase())
    }
}
