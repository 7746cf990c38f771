//! Connection bar, navigation and messages.

use super::wordings;

wordings! {
    /// Connection bar, navigation and messages.
    Frame {
        title: "Maintenance test unit", "정비 시험기";
        connect: "Connect", "연결";
        disconnect: "Disconnect", "연결 해제";
        connecting: "connecting …", "연결 중 …";
        not_connected: "not connected", "연결 안 됨";
        connected: "connected", "연결됨";
        simulated: "simulated unit", "모의 유닛";
        armed: "ARMED: TEST SIGNALS ACT", "ARMED: 시험 신호 작동";
        disarmed: "disarmed", "해제됨";
        stop_all: "Stop all", "전체 정지";
        language: "language", "언어";
        dark: "dark", "어둡게";
        light: "light", "밝게";
        scale: "size", "크기";
    }
}
