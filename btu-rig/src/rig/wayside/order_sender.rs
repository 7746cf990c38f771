//! The wayside's orders: repeated until they are changed, and given up when the unit does not know them.

use protocol::message::{TrainOrder, TwcOrders};

use crate::stimulus::OrderData;

/// Orders in a row without a report after which the unit counts as one that knows no orders: so few that their refusal
/// is no event in the unit.
const GIVEN_UP_AFTER: u8 = 8;

/// Orders in force at the wayside, and whether the unit answers orders with reports.
#[derive(Debug, Default)]
pub struct OrderSender {
    orders: Option<OrderData>,
    unanswered: u8,
    /// Whether the unit answers orders with reports, once that is known.
    pub answered: Option<bool>,
}

impl OrderSender {
    /// Sends these orders from now on, or none. A unit that has answered no order is asked again.
    pub fn set(&mut self, orders: Option<OrderData>) {
        self.orders = orders;
        self.unanswered = 0;
    }

    /// The order that is sent.
    pub fn order(&self) -> TrainOrder {
        self.orders.map(|orders| orders.order).unwrap_or_default()
    }

    /// The message that is due with the wayside's period; `train` is the number of the train.
    pub fn due(&mut self, train: u16) -> Option<TwcOrders> {
        let orders = self.orders?;
        if self.unanswered >= GIVEN_UP_AFTER {
            self.answered = Some(false);
            return None;
        }
        self.unanswered += 1;
        Some(TwcOrders {
            train_number: match orders.train_number {
                0 => train,
                other => other,
            },
            section: orders.section,
            section_length_dm: orders.length_dm,
            destination: orders.destination,
            order: orders.order,
        })
    }

    /// Takes a report.
    pub fn on_report(&mut self) {
        self.unanswered = 0;
        self.answered = Some(true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORDERS: OrderData = OrderData {
        section: 61,
        length_dm: 8500,
        destination: 824,
        order: TrainOrder::PutAway,
        train_number: 0,
    };

    #[test]
    fn a_unit_that_reports_to_no_order_is_asked_no_more() {
        let mut sender = OrderSender::default();
        assert_eq!(sender.due(8001), None);
        sender.set(Some(ORDERS));
        assert_eq!(sender.due(8001).unwrap().train_number, 8001);
        sender.on_report();
        let sent = (0..20).filter(|_| sender.due(8001).is_some()).count();
        assert_eq!(sent, usize::from(GIVEN_UP_AFTER));
        assert_eq!(sender.answered, Some(false));
        sender.set(Some(ORDERS));
        assert!(sender.due(8001).is_some(), "asked again");
    }
}
