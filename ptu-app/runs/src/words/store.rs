//! Messages of the history about its troubles, in both languages: at a command line with what helps there.

use std::path::Path;

use fault_db::{
    FaultAction, FileChange, QueryLimit, ServerReason, StoreError, TraceError, TransitionError,
    WithdrawalError,
};

use super::nouns::{event_kind, fault_state, noun};
use super::{Say, TextStyle, damage};

impl Say for StoreError {
    fn say(&self, how: TextStyle) -> String {
        match how.commands {
            true => how.choose([
                store_message(self),
                with_help(how.choose(in_window(self)), helps(self)),
            ]),
            false => how.choose(in_window(self)),
        }
    }
}

/// The message of a database error. Where its next move is another database, the flag that names one is added.
pub fn store_message(error: &StoreError) -> String {
    match in_place_of(error) {
        Some(_) => format!("{error} with --db"),
        None => error.to_string(),
    }
}

/// The file in whose place an error says to choose another.
pub fn in_place_of(error: &StoreError) -> Option<&Path> {
    match error {
        StoreError::Locked(path)
        | StoreError::Full(path)
        | StoreError::ReadOnly(path)
        | StoreError::NotADatabase(path)
        | StoreError::ForeignDatabase { path, .. }
        | StoreError::NewerSchema { path, .. }
        | StoreError::Missing(path)
        | StoreError::CannotOpen { path, .. }
        | StoreError::NotAFile(path) => Some(path),
        _ => None,
    }
}

/// A sentence, and behind it the command or option that helps, if there is one.
fn with_help(said: String, help: &str) -> String {
    match help {
        "" => said,
        help => format!("{said} ({help})"),
    }
}

/// The commands and options that help, for the Korean sentence, which names none.
fn helps(error: &StoreError) -> &'static str {
    use StoreError as S;
    match error {
        S::Altered { .. } => "`ptu db check`, `ptu db query`",
        S::EarlierCopy { .. } => "`ptu db sync --as-copy`",
        S::ForkedCopy { .. } => "`ptu db import`, `ptu db sync --as-copy`",
        S::Io { .. } | S::Malformed(_) | S::Corrupt { .. } => "`ptu db check`",
        S::NotAFile(_) => "`ptu db sync`",
        S::ServerEmpty(_) | S::ServerOlderSchema { .. } => "`ptu db server init ADDRESS`",
        other if in_place_of(other).is_some() => "--db",
        _ => "",
    }
}

/// Message of the store without a command; the store's own English where it names no command.
#[rustfmt::skip]
pub(super) fn in_window(error: &StoreError) -> [String; 2] {
    use StoreError as S;
    let same = |korean: String| [error.to_string(), korean];
    match error {
        S::Locked(path) => same(format!("다른 프로그램이 데이터베이스를 사용 중입니다: {}. 그 프로그램을 닫거나 다른 파일을 선택하십시오", path.display())),
        S::Stopped => same("끝나기 전에 중지됨".to_owned()),
        S::Full(path) => same(format!("저장 공간이 부족하여 쓸 수 없습니다: {} (이미 기록된 내용은 그대로 있습니다). 공간을 확보하거나 다른 디스크를 선택하십시오", path.display())),
        S::ReadOnly(path) => same(format!("읽기 전용이라 쓸 수 없습니다: {}. 파일과 폴더에 쓰기 권한을 주거나 다른 파일을 선택하십시오", path.display())),
        S::NotADatabase(path) => same(format!("데이터베이스가 아닙니다: {}. 다른 파일을 선택하십시오", path.display())),
        S::ForeignDatabase { path, application_id } => same(format!("다른 프로그램의 데이터베이스입니다: {} (프로그램 번호 {application_id:#010x}). 다른 파일을 선택하십시오", path.display())),
        S::NewerSchema { path, found, known } => same(format!("더 새로운 버전에서 만든 파일입니다: {} (형식 {found}, 이 버전은 {known}까지). 프로그램을 업데이트하거나 다른 파일을 선택하십시오", path.display())),
        S::Altered { path, what, more } => {
            let (more, more_ko) = match more {
                0 => Default::default(),
                n => (format!(", and {n} more"), format!(", 외 {n}건")),
            };
            let path = path.display();
            [
                format!("{path} was altered by hand: {what}{more}; nothing is written to it. Keep a copy of it as it is, then go on with a backup, or take out by hand what is not of this program and check it again"),
                format!("파일이 임의로 변경되어 기록하지 않습니다: {path} ({}{more_ko}). 이 파일의 사본을 그대로 보관하고 백업으로 계속하거나, 이 프로그램의 것이 아닌 내용을 제거한 후 다시 검사하십시오", damage::korean(what)),
            ]
        }
        S::FileChanged { path, what } => same(match what {
            FileChange::Removed => format!("데이터베이스 파일이 삭제되었습니다: {}", path.display()),
            FileChange::Replaced => format!("데이터베이스가 다른 파일로 바뀌었습니다: {}", path.display()),
            FileChange::SecondName => format!("데이터베이스에 다른 이름(하드 링크)이 있습니다: {}. 그 이름을 지우십시오", path.display()),
            FileChange::NoLog => format!("데이터베이스 옆의 기록 파일(-wal)이 삭제되거나 바뀌었습니다: {}", path.display()),
            FileChange::WrittenOver => format!("데이터베이스에 다른 내용이 덮어써져 시험이 기록된 그대로 남아 있지 않습니다: {}", path.display()),
            FileChange::Gone => format!("데이터베이스가 없어졌습니다: {}", path.display()),
        }),
        S::EarlierCopy { path, here, there } => [
            format!("{} is a copy from before: it ends with entry {here} of its chain of seals, and {there} are known there; go on with the file itself", path.display()),
            format!("이전에 만든 사본입니다: {}. 봉인 사슬의 기록은 {here}건이고 상대편에는 {there}건이 있습니다. 원본 파일로 계속하십시오", path.display()),
        ],
        S::ForkedCopy { path, after } => [
            format!("{} is a copy that went on by itself after entry {after} of its chain of seals: what is known there of it after that is not in it; import it into the file itself", path.display()),
            format!("봉인 사슬의 {after}번째 기록 이후 따로 이어진 사본입니다: {}. 원본 파일에 이 파일을 가져오십시오", path.display()),
        ],
        S::Rewritten { path, after, what, id } => same(format!("봉인 사슬의 {after}번째 기록 이후 이력이 변경되었습니다: {} ({} {id}의 내용이 봉인과 다름). 아무것도 받지 않았습니다. 파일을 그대로 보관하고 백업이나 새 파일로 계속하십시오", path.display(), noun(what))),
        S::OlderSchema { path, found, known } => same(format!("이전 형식의 파일입니다: {} (형식 {found}, 이 버전은 {known}). 쓰기용으로 한 번 열어 형식을 올리십시오", path.display())),
        S::Missing(path) => same(format!("데이터베이스가 없습니다: {}. 첫 시험 때 만들어집니다. 또는 다른 파일을 선택하십시오", path.display())),
        S::CannotOpen { path, reason } => same(format!("열 수 없습니다: {} ({reason}). 경로와 폴더를 확인하거나 다른 파일을 선택하십시오", path.display())),
        S::Io { path, reason } => [
            format!("reading or writing {} failed ({reason}); check the disk, then the history", path.display()),
            format!("읽기 또는 쓰기에 실패했습니다: {} ({reason}). 디스크를 점검한 후 이력을 검사하십시오", path.display()),
        ],
        S::Malformed(path) => [
            format!("{} is damaged; check the history, then go on with a backup", path.display()),
            format!("파일이 손상되었습니다: {}. 이력을 검사한 후 백업으로 계속하십시오", path.display()),
        ],
        S::Corrupt { path, detail } => [
            format!("{} is damaged ({detail}); check the history, then go on with a backup", path.display()),
            format!("파일이 손상되었습니다: {} ({detail}). 이력을 검사한 후 백업으로 계속하십시오", path.display()),
        ],
        S::NotFound { what, asked } => [format!("no {what} {asked:?}"), format!("{} {asked:?}이(가) 없습니다", noun(what))],
        S::TraceMissing { asked, run } => same(format!("시험 {run}의 신호 기록 {asked:?}이(가) 없습니다: 정리되었거나, 제거되었거나, 봉인과 맞지 않아 받지 않은 것입니다. 기록한 파일의 전체 사본을 가져오면 복구됩니다")),
        S::Ambiguous { what, asked, matches } => {
            let matches: Vec<_> = matches.iter().map(ToString::to_string).collect();
            same(format!("{asked:?}에 해당하는 {}이(가) 둘 이상입니다: {}. 더 길게 입력하십시오", noun(what), matches.join(", ")))
        }
        S::NoWords(asked) => same(format!("{asked:?}: 검색할 단어가 없습니다. 글자나 숫자를 입력하십시오")),
        S::BadId { what, asked } => [
            format!("{asked:?} is no {what} id: give a full id, or at least four hex digits of its beginning or end"),
            format!("{asked:?}은(는) {} 번호가 아닙니다. 전체 번호 또는 앞이나 뒤의 16진수 네 자리 이상을 입력하십시오", noun(what)),
        ],
        S::TextTooLong { what, length, most } => same(format!("{}이(가) {length}자입니다. {most}자 이하로 줄이십시오", noun(what))),
        S::Transition { fault, source: TransitionError { from, action } } => {
            let can: Vec<_> = FaultAction::BY_A_PERSON.into_iter().filter(|action| from.next(*action).is_ok()).map(|action| event_kind(action.event_kind())).collect();
            same(format!("고장 {fault}: 현재 상태 {}에서는 {}(으)로 바꿀 수 없습니다. 가능한 상태: {}", fault_state(*from), event_kind(action.event_kind()), can.join(", ")))
        }
        S::Withdrawal(fault, why) => same(match why {
            WithdrawalError::NothingWritten => format!("고장 {fault}: 되돌릴 수 있는 기록이 없습니다"),
            WithdrawalError::OtherWritten { kind, who } => format!("고장 {fault}: 마지막 기록은 다른 것입니다: {} ({who})", event_kind(kind)),
            WithdrawalError::Rested { kind, after } => format!("고장 {fault}: {} 이후의 {} 기록이 이에 근거합니다. 다른 상태나 메모로 바로잡으십시오", event_kind(kind), event_kind(after)),
            WithdrawalError::SeenSince => format!("고장 {fault}: 종결 후 다시 발생하여 별도의 고장이 되었습니다"),
        }),
        S::StepOrder { index, last } => same(format!("단계 {last} 다음에 단계 {index}이(가) 기록됨: 단계 번호는 증가해야 합니다")),
        S::RunFinished(run) => same(format!("시험 {run}은(는) 끝났습니다. 더 기록하려면 새 시험을 시작하십시오")),
        S::StepsWaiting { path, waiting } => same(format!("{}에 쓸 수 없어 단계 {waiting}개가 메모리에서 대기 중입니다. 시험을 정지하십시오", path.display())),
        S::Trace { trace, source } => same(format!("신호 기록 {trace}: {}", samples(source))),
        S::TargetExists(path) => same(format!("파일이 이미 있습니다: {}. 다른 이름을 적으십시오", path.display())),
        S::CannotWrite { path, reason } => same(format!("쓸 수 없습니다: {} ({reason}). 다른 대상을 적으십시오", path.display())),
        S::SameFile(path) => same(format!("자기 자신은 가져올 수 없습니다: {}. 다른 파일을 적으십시오", path.display())),
        S::QueryRefused(reason) => same(format!("읽기 문장 하나만 허용됩니다 ({reason}). SELECT 하나만 적으십시오")),
        S::QueryFailed(reason) => same(format!("조회 실패: {reason}")),
        S::QueryExceeds(limit) => same(format!("조회를 중단했습니다: {}", match limit {
            QueryLimit::Stopped => "시간이 너무 오래 걸림",
            QueryLimit::Memory => "메모리가 너무 많이 필요함",
            QueryLimit::Row => "한 행이 너무 김",
        })),
        S::NotAFile(path) => [
            format!("{} is a server, and this needs a history file", path.display()),
            format!("서버입니다: {}. 이 작업에는 이력 파일이 필요합니다", path.display()),
        ],
        S::NotAServer(path) => same(format!("파일입니다: {}. 이 작업에는 서버가 필요합니다. postgres://USER@HOST/DATABASE 형식으로 적으십시오", path.display())),
        S::BadAddress(reason) => same(format!("잘못된 서버 주소: {reason}. postgres://USER@HOST/DATABASE 형식으로 적으십시오")),
        S::ServerUnreachable { path, reason, .. } => same(format!("서버에 연결할 수 없습니다: {} ({}). 네트워크와 서버를 확인한 후 다시 시도하십시오 (기록은 모두 노트북 파일에 있습니다)", path.display(), server(reason))),
        S::ServerRefuses { path, reason } => same(format!("서버가 거부했습니다: {} ({}). 서버 담당자에게 문의하십시오", path.display(), server(reason))),
        S::ServerNotTrusted { path, reason } => same(format!("서버를 신뢰할 수 없습니다: {} ({})", path.display(), server(reason))),
        S::ServerBusy { path, reason, .. } => same(format!("서버가 사용 중입니다: {} ({reason}). 나중에 다시 시도하십시오", path.display())),
        S::ServerEmpty(path) => [
            format!("there is no history on {} yet; who looks after the server makes its tables once", path.display()),
            format!("서버에 아직 이력이 없습니다: {}. 서버 담당자가 먼저 테이블을 만들어야 합니다", path.display()),
        ],
        S::ServerSetup { path, reason } => same(format!("서버를 준비하지 못했습니다: {} ({reason})", path.display())),
        S::ServerForeign(path) => [
            format!("the database of {} holds tables of another program; it needs one of its own", path.display()),
            format!("서버의 데이터베이스에 다른 프로그램의 테이블이 있습니다: {}. 전용 데이터베이스가 필요합니다", path.display()),
        ],
        S::ServerOlderSchema { path, found, known } => [
            format!("{} has the older schema {found} (this program knows {known}); who looks after the server brings it up to date", path.display()),
            format!("서버의 형식이 이전 버전입니다: {} (형식 {found}, 이 프로그램은 {known}). 서버 담당자가 형식을 올려야 합니다", path.display()),
        ],
        S::ServerNewerSchema { path, found, known } => [
            format!("this program knows schema {known}, {} has schema {found}; update the program", path.display()),
            format!("서버의 형식이 더 새롭습니다: {} (형식 {found}, 이 프로그램은 {known}까지). 프로그램을 업데이트하십시오", path.display()),
        ],
        S::Server { path, source, .. } => same(format!("서버 오류: {} ({source})", path.display())),
        S::Sqlite { path, source, .. } => same(format!("데이터베이스 오류: {} ({source})", path.display())),
    }
}

#[rustfmt::skip]
fn server(reason: &ServerReason) -> &str {
    use ServerReason as R;
    match reason {
        R::NothingListens => "응답하는 서버가 없음",
        R::NoAnswer => "제한 시간 안에 응답 없음",
        R::NoSocket => "소켓이 없음",
        R::Lost => "연결이 끊김",
        R::NoPassword => "비밀번호가 필요함",
        R::NoTls => "TLS를 지원하지 않음. 신뢰하는 네트워크라면 주소에 sslmode=disable을 추가하십시오",
        R::UnknownIssuer => "인증서 발급자를 알 수 없음. 주소에 sslrootcert=FILE로 발급자의 인증서를 지정하십시오",
        R::OtherHost => "다른 호스트의 인증서임. 인증서에 있는 이름을 쓰십시오",
        R::Expired => "인증서가 만료됨. 갱신하거나 이 컴퓨터의 시계를 맞추십시오",
        R::NotYetValid => "인증서가 아직 유효하지 않음. 이 컴퓨터의 시계를 맞추십시오",
        R::Said(words) => words,
    }
}

#[rustfmt::skip]
fn samples(error: &TraceError) -> String {
    use TraceError as T;
    match error {
        T::ChannelCount { channels, columns } => format!("채널은 {channels}개이나 열은 {columns}개임"),
        T::RowCount { channel, rows, found } => format!("채널 {channel:?}의 값은 {found}개이나 다른 채널은 {rows}개임"),
        T::DuplicateChannel { channel } => format!("채널 {channel:?}이(가) 두 번 있음"),
        T::Lsb { channel, lsb } => format!("채널 {channel:?}의 분해능 {lsb}이(가) 양수가 아님"),
        T::Period { period_us } => format!("주기 {period_us} µs가 양수가 아님"),
        T::TriggerRow { row, rows } => format!("행이 {rows}개이나 트리거 행은 {row}임"),
        T::TooLarge { rows, columns } => format!("행 {rows}개, 채널 {columns}개는 너무 많음"),
        T::UnknownChannel { channel, known } => format!("신호 기록에 채널 {channel:?}이(가) 없음. 있는 채널: {}", known.join(", ")),
        T::Encoding { found } => format!("알 수 없는 형식 {found}: 더 새로운 버전에서 기록함"),
        T::Checksum => "저장된 데이터가 체크섬과 다름: 손상됨".to_owned(),
        T::ChannelSet { detail } => format!("채널 목록을 읽을 수 없음: {detail}"),
        T::Blob { offset, .. } => format!("{offset}바이트 위치에서 손상됨"),
        T::Column { channel, .. } => format!("채널 {channel:?} 손상됨"),
        T::Compression { detail } => format!("압축 실패: {detail}"),
    }
}

#[cfg(test)]
mod tests;
